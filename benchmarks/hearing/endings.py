"""When an utterance counts as over: after a command, and within a sentence.

Held-out voices of Kokoro and espeak-ng (`training.acoustics`) say eight commands, and ten sentences
with a pause of 0.3 to 0.8 s; the rules were made with these sentences. Recognising words counts as
0.25 s, so no command is known before 0.45 s; `voice` measures the real delay. If the words before a
pause are a whole command, it begins, and is taken back when the rest is heard: such a sentence
counts as begun, not as cut.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from corpus_robots import skills_of_robots
from listener_rig import frames

from benchmarks.core.figures import Figure, Measured
from edgevox.agent.agents import Agent
from edgevox.agent.nlu.hearing.endings import Endings
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.speech import Ending
from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.utterance_end import (
    ENDS_AFTER_S,
    Endpointer,
    SpeechEnded,
    SpeechPaused,
    SpeechWentOn,
)
from edgevox.voice.vad import open_vad
from training.acoustics import Half
from training.acoustics.voices import espeak_voices, native_voices, say

TABLE = "The end of an utterance"
STT_S = 0.25
"""What Whisper takes for a short command; tiny.en takes less on two cores that do nothing else."""
COMMANDS = (
    "Go to the kitchen.", "Please drive to the living room.", "Where are you?",
    "What is your battery level?", "Go to the bedroom.", "Drive to the office, please.",
    "What can you do?", "Stop!",
)  # fmt: skip
PARTS = (
    ("Go to the", "kitchen."), ("Please drive", "to the bedroom."),
    ("What is your", "battery level?"),
    ("Go to the kitchen", "and then to the bedroom."), ("Could you", "go to the living room?"),
    ("Tell me", "where you are."), ("Drive to the", "office, please."),
    ("Go to the bedroom", "in ten minutes."), ("I would like you", "to drive to the kitchen."),
    ("Go", "to the living room."),
)  # fmt: skip
PAUSES_S = (0.3, 0.5, 0.65, 0.8)


@dataclass(frozen=True, slots=True)
class Utterance:
    """Its first and last voice, and when it was over, in seconds; infinity if it has no end."""

    began_s: float
    ended_s: float
    over_s: float
    words: str
    """What was understood of it at its last pause."""


@dataclass
class Heard:
    """The utterances of a sound, and how often one that was over went on."""

    utterances: list[Utterance] = field(default_factory=list)
    taken_back: int = 0


def listen(sound: Samples, whisper: Whisper, ending: Callable[[str], Ending] | None) -> Heard:
    """What the endpointer makes of it; with `ending`, by the words as the listener would."""
    vad, endpointer, found = open_vad(), Endpointer(), Heard()
    known: tuple[float, Ending, float] | None = None
    words = ""
    for frame in frames(sound):
        if known and frame.end_s >= known[2] and endpointer.paused_at == known[0]:
            plain = known[1] in (Ending.WHOLE, Ending.MAY_GO_ON)
            endpointer.end_after(ENDS_AFTER_S[known[1]], revocable=plain)
            known = None
        match endpointer.push(frame, vad.probability(frame.samples)):
            case SpeechPaused(samples=samples, ended_s=ended_s) if ending:
                endpointer.end_after(ENDS_AFTER_S[Ending.OPEN])
                words = whisper.transcribe(samples, "en").text
                known = ended_s, ending(words), frame.end_s + STT_S
            case SpeechEnded(began_s=began_s, ended_s=ended_s):
                found.utterances.append(Utterance(began_s, ended_s, frame.end_s, words))
            case SpeechWentOn():
                found.utterances.pop()
                found.taken_back += 1
    if last := endpointer.finish():
        found.utterances.append(Utterance(last.began_s, last.ended_s, np.inf, words))
    return found


def measure(quick: bool = False) -> Measured:
    """Both ways: a fixed silence, and the words."""
    whisper = recogniser()
    voices = (*native_voices(Half.HELD_OUT), *espeak_voices(Half.HELD_OUT)[::17])
    voices = voices[:: 5 if quick else 1]
    ways = {"a fixed silence": None, "by its words": endings().of}
    return Measured(
        figures=tuple(
            figure
            for name, ending in ways.items()
            for figure in _figures(name, ending, whisper, voices)
        )
    )


def _figures(
    name: str, ending: Callable[[str], Ending] | None, whisper: Whisper, voices: tuple[str, ...]
) -> Iterator[Figure]:
    key = "words" if ending else "silence"
    waits = [
        last.over_s - last.ended_s
        for voice in voices
        for text in COMMANDS
        for last in listen(_padded(say(voice, text)), whisper, ending).utterances[-1:]
    ]
    said = [1000 * max(wait, STT_S + 0.2) for wait in waits]
    yield Figure.of(f"command.{key}", TABLE, name, said, "ms", column="command to its words")
    heard = [
        listen(_padded(say(voice, first), pause_s, say(voice, rest)), whisper, ending)
        for voice in voices
        for first, rest in PARTS
        for pause_s in PAUSES_S
    ]
    yield Figure.share(
        f"cut.{key}", TABLE, name, sum(len(one.utterances) > 1 for one in heard), len(heard),
        column="sentences cut at a pause", wanted=1.0 if ending else None,
    )  # fmt: skip
    yield Figure.share(
        f"taken_back.{key}", TABLE, name, sum(one.taken_back > 0 for one in heard), len(heard),
        column="begun at a pause, and taken back",
    )  # fmt: skip


def _padded(first: Samples, pause_s: float = 0.0, rest: Samples | None = None) -> Samples:
    parts = [_quiet(1.0), first]
    if rest is not None:
        parts += [_quiet(pause_s), rest]
    return np.concatenate([*parts, _quiet(2.0)])


def _quiet(seconds: float) -> Samples:
    rng = np.random.default_rng(7)
    return rng.normal(0, 10, round(seconds * RATE_HZ)).astype(np.int16)


def recogniser() -> Whisper:
    """English speech to text, with the words of the phrasebook as its prompt."""
    return Whisper(
        lambda _: locate("whisper-tiny.en"),
        prompt_of=lambda code: phrasebook(code).hearing.written,
    )


def endings() -> Endings:
    """How words of an English order to `robot-apartment` end."""
    agent = Agent("robot", "", skills_of_robots()["robot-apartment"])
    interpreter = Interpreter([agent], Bus(), SystemClock())
    return Endings(
        interpreter.plain,
        is_stop=lambda text: find_stop_word("en", text) is not None,
        hearing=lambda: interpreter.phrases.hearing,
    )
