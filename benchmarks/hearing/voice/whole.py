"""The whole voice: errors, time to an answer and to silence, cost.

Four voices of Kokoro speak to it, ten others say the stop words, in quiet; Piper answers. The floor
is the time of the parts alone, one after another, on the same sound in the same run.
"""

import itertools
import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from listener_rig import chatter, loud
from voice_engines import words, wrong_words
from voice_rig import VoiceRig

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.listening import NoWords, listen, quiet_room, spotting
from benchmarks.hearing.voice import parts as voice_parts
from benchmarks.hearing.voice.endurance import Endured, endure
from benchmarks.hearing.voice.stops import spoken_stops, stop_figures
from benchmarks.hearing.voice.turns import Talk, Turn
from edgevox.apps.agent.queries import find_model
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.tts.voices import choose
from edgevox.voice.wake.micro import MicroWakeWord

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
MINUTES, SILENCE_S = 60, 60.0
MANY = 3
"""So many sentences, and more, are an answer in which overlap counts."""
TURNS, LISTENING, PARTS = "Speaking with it", "Listening", "The parts of the voice, each alone"


class Patch:
    """What the rig of the tests needs of pytest."""

    def setattr(self, module: object, name: str, value: object) -> None:
        setattr(module, name, value)


def measure(quick: bool = False) -> Measured:
    """Turns, barging in, silence, an hour of listening, and the parts alone."""
    try:
        return Measured(
            figures=(
                *turns(quick),
                *cost(5.0 if quick else SILENCE_S),
                *endurance(1 if quick else MINUTES),
                *parts(),
            )
        )
    except ModelMissing as error:
        raise NotHere(str(error)) from error


def turns(quick: bool) -> Iterator[Figure]:
    """The commands, the times of barging in, and the questions with long answers."""
    talk = Talk()
    try:
        commands = [talk.ask(said) for said in (COMMANDS[:2] if quick else COMMANDS)]
        barge_ins = [talk.speak_over() for _ in range(2 if quick else BARGE_INS)]
        stops = spoken_stops(talk, quick)
    finally:
        talk.close()
    talk = Talk(talkative=True)
    try:
        questions = [talk.ask(said) for said in (QUESTIONS[:2] if quick else QUESTIONS)]
    finally:
        talk.close()
    yield from _commands(commands)
    yield _s("barge_in", "speaking over it: first voiced to last played sample", barge_ins)
    yield from stop_figures(TURNS, stops)
    many = [one for one in questions if one.sentences >= MANY]
    if many:
        yield from _long_answers(many)


def _commands(spoken: Sequence[Turn]) -> Iterator[Figure]:
    yield Figure.of(
        "word_errors", TURNS, f"word error rate of {len(spoken)} spoken commands",
        [100 * word_error_rate(spoken)], "%",
    )  # fmt: skip
    yield _s(
        "action", "command: last voiced sample to the action",
        [x.action_s for x in spoken if not math.isnan(x.action_s)], wanted=0.45,
    )  # fmt: skip
    yield _s(
        "first_sound", "command: last voiced to first audible sample",
        [x.ttfs_s for x in spoken], wanted=0.7,
    )  # fmt: skip
    yield _s("silence", "of it the silence that ends an utterance", [x.wait_s for x in spoken])
    yield _s("floor_stt", "floor: speech to text alone", [x.stt_s for x in spoken])
    yield _s("floor_tts", "floor: first chunk of speech alone", [x.first_chunk_s for x in spoken])
    yield _ratio(
        "to_floor", "one sentence: time to first sound without that silence / floor", spoken,
        lambda x: (x.ttfs_s - x.wait_s) / x.first_floor_s, 1.10,
    )  # fmt: skip
    yield _ratio(
        "to_floor_silence", "the same with that silence", spoken,
        lambda x: x.ttfs_s / x.first_floor_s,
    )  # fmt: skip


def _long_answers(many: Sequence[Turn]) -> Iterator[Figure]:
    about = f"answer of {MANY} sentences or more"
    yield _s("long_first_sound", f"{about}: time to first sound", [x.ttfs_s for x in many])
    yield _s("floor_model", "floor: model alone, whole answer", [x.model_s for x in many])
    yield _s("floor_speech", "floor: all speech alone", [x.synthesis_s for x in many])
    yield _ratio(
        "long_to_floor", f"{about}: without that silence / floor of everything", many,
        lambda x: (x.ttfs_s - x.wait_s) / x.whole_floor_s, 0.80,
    )  # fmt: skip
    yield _ratio(
        "long_to_floor_silence", f"{about}: with that silence / floor of everything", many,
        lambda x: x.ttfs_s / x.whole_floor_s,
    )  # fmt: skip


def cost(seconds: float) -> Iterator[Figure]:
    """The share of a core that listening takes, to a quiet room and to people who speak."""
    stt = Whisper(lambda _: locate("whisper-tiny.en"))
    stt.warm_up("en")
    wakeword = MicroWakeWord(locate("micro-wake-words") / "hey_jarvis.json")
    for name, word in (("without", None), ("with", wakeword)):
        share = listen(stt, quiet_room(seconds), wakeword=word).share_of_a_core
        yield Figure.of(
            f"listening_{name}", LISTENING, f"listening to silence {name} a wake word",
            [100 * share], "% of a core", wanted=5.0,
        )  # fmt: skip
    talk = loud(np.concatenate(list(itertools.islice(chatter(), 20))), 0.08)
    share = listen(NoWords(), talk[: round(seconds * RATE_HZ)], wakeword=wakeword).share_of_a_core
    yield Figure.of(
        "listening_speech", LISTENING,
        "listening to speech for a wake word and stop words, without recognising it",
        [100 * share], "% of a core", wanted=8.0,
    )  # fmt: skip
    for name, about, voice, most in (
        ("speech", "while somebody speaks", 1.0, 7.0),
        ("else", "while nobody does", 0.0, 1.0),
    ):
        yield Figure.of(
            f"spotting_{name}", LISTENING, f"of it the stop word spotter, {about}",
            [100 * spotting(seconds, voice)], "% of a core", wanted=most,
        )  # fmt: skip
    wakeword.close()
    stt.close()


def endurance(minutes: int) -> Iterator[Figure]:
    """So much sound in a loop, as fast as it goes."""
    with (
        tempfile.TemporaryDirectory() as folder,
        VoiceRig(Patch(), Path(folder, "answers.wav"), robot="robot-apartment") as rig,
    ):
        found: Endured = endure(rig, minutes)

    def one(name: str, what: str, value: float, unit: str, **more: object) -> Figure:
        what = f"{minutes} minutes of sound in a loop: {what}"
        return Figure.of(name, LISTENING, what, [value], unit, **more)

    yield one("hour_turns", "turns", found.turns, "")
    yield one("hour_memory", "growth of memory", found.memory_growth_kib / 1024, "MiB")
    yield one(
        "hour_late_memory", "growth of memory in the last quarter",
        found.late_memory_growth_kib / 1024, "MiB",
    )  # fmt: skip
    yield one("hour_threads", "growth of threads", found.thread_growth, "", wanted=0)
    yield one("hour_first", "half a minute, in the first quarter", found.first_took_s, "s")
    yield one("hour_last", "half a minute, in the last quarter", found.last_took_s, "s")


def parts() -> Iterator[Figure]:
    """Every engine alone: the English voices, the French ones, and both models that hear."""
    rows = [*voice_parts.measure_voices("en"), *voice_parts.measure_voices("fr")]
    for language in ("en", "fr"):
        recordings = voice_parts.record(choose(language, "", find_model)[0])
        rows.append(voice_parts.measure_speech_to_text(recordings, language))
    for one in rows:
        name = f"part.{one.name.lower()}"
        for part, column, value, unit in (
            ("load", "warm after", one.load_s, "s"),
            ("factor", "work for a second of sound", one.factor, "s"),
            ("first", "first sound or words", one.first_s, "s"),
        ):
            yield Figure.of(f"{name}.{part}", PARTS, one.name, [value], unit, column=column)


def word_error_rate(spoken: Sequence[Turn]) -> float:
    """Wrong words, of all that were said."""
    wrong = sum(wrong_words(words(one.said), words(one.heard)) for one in spoken)
    return wrong / sum(len(words(one.said)) for one in spoken)


def _s(identifier: str, what: str, samples: Sequence[float], wanted: float | None = None) -> Figure:
    return Figure.of(identifier, TURNS, what, samples, "s", wanted=wanted)


def _ratio(
    identifier: str,
    what: str,
    spoken: Sequence[Turn],
    ratio: Callable[[Turn], float],
    wanted: float | None = None,
) -> Figure:
    return Figure.of(identifier, TURNS, what, [ratio(one) for one in spoken], "x", wanted=wanted)
