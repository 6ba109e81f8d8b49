"""The whole voice: how right it hears, how soon it answers, how soon it is silent, what it costs.

Run it with ``make bench`` on a machine that does nothing else; it writes `voice.md` beside this
file. `--minutes` is how much sound it hears in a loop at the end; 60 by default.
"""

import argparse
import statistics
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests" / "models"))

import voice_parts  # noqa: E402
from ears import listen, quiet_room  # noqa: E402
from machine import machine  # noqa: E402
from voice_endurance import Endured, endure  # noqa: E402
from voice_engines import words, wrong_words  # noqa: E402
from voice_stage import Stage  # noqa: E402
from voice_turns import Talk, Turn  # noqa: E402

from edgevox.apps.queries import find_model  # noqa: E402
from edgevox.models import locate  # noqa: E402
from edgevox.voice.stt.whisper import Whisper  # noqa: E402
from edgevox.voice.voices import choose  # noqa: E402
from edgevox.voice.wakeword import WakeWord  # noqa: E402

COMMANDS = (
    "go to the kitchen",
    "where are you",
    "what is your battery level",
    "drive to the bedroom",
    "go to the office",
    "how much power is left",
    "head to the living room",
    "please go to the kitchen",
    "could you go to the bedroom",
    "tell me where you are",
    "how much battery is left",
    "go to the bedroom please",
    "drive to the office",
    "go to the living room",
    "can you drive to the kitchen",
    "what is your position",
    "head to the office",
    "robot go to the kitchen",
    "please tell me where you are",
    "drive to the living room",
)
QUESTIONS = (
    "why is the sky blue",
    "how do bees make honey",
    "what happens to the trees in autumn",
    "why do people like to look at the sea",
    "what is a lighthouse good for",
    "how does a bicycle stay upright",
)
BARGE_INS = 10
MANY = 3
"""So many sentences, and more, are an answer in which overlap counts."""


class Patch:
    """What the stage of the tests needs of pytest."""

    def setattr(self, module: object, name: str, value: object) -> None:
        setattr(module, name, value)


def measure_turns() -> tuple[list[Turn], list[Turn], list[float]]:
    """The commands, the questions with long answers, and the times of barging in."""
    talk = Talk()
    try:
        commands = [talk.ask(said) for said in COMMANDS]
        barge_ins = [talk.speak_over() for _ in range(BARGE_INS)]
    finally:
        talk.close()
    talk = Talk(talkative=True)
    try:
        questions = [talk.ask(said) for said in QUESTIONS]
    finally:
        talk.close()
    return commands, questions, barge_ins


def measure_endurance(minutes: int) -> Endured:
    """So much sound in a loop, as fast as it goes."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Stage(Patch(), Path(folder, "answers.wav"), robot="robot-apartment") as stage,
    ):
        return endure(stage, minutes)


def measure_silence() -> dict[str, float]:
    """The share of a core that listening to a quiet room takes."""
    stt = Whisper(lambda _: locate("whisper-tiny.en"))
    stt.warm_up("en")
    wakeword = WakeWord("hey jarvis", locate("wake-words"))
    shares = {
        "without a wake word": listen(stt, quiet_room(60.0)).share_of_a_core,
        "with a wake word": listen(stt, quiet_room(60.0), wakeword=wakeword).share_of_a_core,
    }
    wakeword.close()
    stt.close()
    return shares


def measure_parts() -> list[voice_parts.Measured]:
    """Every engine alone: the English voices, the French ones, and both models that hear."""
    rows = [*voice_parts.measure_voices("en"), *voice_parts.measure_voices("fr")]
    for language in ("en", "fr"):
        recordings = voice_parts.record(choose(language, "", find_model)[0])
        rows.append(voice_parts.measure_ears(recordings, language))
    return rows


def word_error_rate(turns: Sequence[Turn]) -> float:
    """Wrong words, of all that were said."""
    wrong = sum(wrong_words(words(one.said), words(one.heard)) for one in turns)
    return wrong / sum(len(words(one.said)) for one in turns)


def turn_rows(commands: Sequence[Turn], questions: Sequence[Turn]) -> list[tuple[str, str, str]]:
    """What, how much, and what was wanted."""
    many = [one for one in questions if one.sentences >= MANY]
    rows = [
        ("commands", str(len(commands)), ""),
        ("word error rate", f"{word_error_rate(commands):.1%}", ""),
        ("time to first sound, from the last voiced sample, s", _s(x.ttfs_s for x in commands), ""),
        ("of it the silence that ends an utterance, s", _s(x.wait_s for x in commands), ""),
        ("floor: speech to text alone, s", _s(x.stt_s for x in commands), ""),
        ("floor: first chunk of speech alone, s", _s(x.first_chunk_s for x in commands), ""),
        (
            "one sentence: time to first sound without that silence / floor",
            _ratio((x.ttfs_s - x.wait_s) / x.first_floor_s for x in commands),
            "1.10",
        ),
        (
            "the same with that silence",
            _ratio(x.ttfs_s / x.first_floor_s for x in commands),
            "",
        ),
        (f"answers of {MANY} sentences or more", str(len(many)), ""),
    ]
    if many:
        rows += [
            ("time to first sound, s", _s(x.ttfs_s for x in many), ""),
            ("floor: model alone, whole answer, s", _s(x.model_s for x in many), ""),
            ("floor: all speech alone, s", _s(x.synthesis_s for x in many), ""),
            (
                "time to first sound without that silence / floor of everything",
                _ratio((x.ttfs_s - x.wait_s) / x.whole_floor_s for x in many),
                "0.80",
            ),
            (
                "the same with that silence",
                _ratio(x.ttfs_s / x.whole_floor_s for x in many),
                "",
            ),
        ]
    return rows


def report(minutes: int) -> str:
    """All of it, as Markdown."""
    commands, questions, barge_ins = measure_turns()
    rows = turn_rows(commands, questions)
    rows.append(("barge-in: first voiced sample to last played sample, s", _s(barge_ins), ""))
    rows += [
        (f"listening to silence {name}, of a core", f"{share:.1%}", "5 %")
        for name, share in measure_silence().items()
    ]
    endured = measure_endurance(minutes)
    rows += [
        (f"{endured.minutes} minutes in a loop: turns", str(endured.turns), ""),
        ("growth of memory, MB", f"{endured.memory_growth_kib / 1024:.1f}", ""),
        ("of it in the last quarter", f"{endured.late_memory_growth_kib / 1024:.1f}", "0"),
        ("growth of threads", str(endured.thread_growth), "0"),
        (
            "latency of a turn, first and last quarter, s",
            f"{endured.first_latency_s:.2f}, {endured.last_latency_s:.2f}",
            "equal",
        ),
    ]
    parts = "\n".join(
        f"| {x.name} | {x.load_s:.2f} | {x.factor:.2f} | {x.first_s:.2f} |" for x in measure_parts()
    )
    table = "\n".join(f"| {what} | {value} | {wanted} |" for what, value, wanted in rows)
    return (
        "# The voice\n\nWritten by `benchmarks/voice.py`. Four voices of Kokoro speak to it, Piper "
        "answers; figures are medians, with the largest in brackets. The floor is what the parts "
        "need alone, one after another, on the same sound and words in the same run.\n\n"
        f"Measured on {machine()}.\n\n| what | measured | wanted |\n|---|---:|---:|\n{table}\n\n"
        "| part | warm after, s | seconds of work for one of sound | first sound or words, s |\n"
        f"|---|---:|---:|---:|\n{parts}\n"
    )


def _s(values: object) -> str:
    found = list(values)  # type: ignore[call-overload]
    return f"{statistics.median(found):.2f} ({max(found):.2f})"


_ratio = _s


def main() -> None:
    """Measure, write the table, print it."""
    arguments = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    arguments.add_argument("--minutes", type=int, default=60)
    arguments.add_argument("--output", type=Path, default=HERE / "voice.md")
    given = arguments.parse_args()
    text = report(given.minutes)
    given.output.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
