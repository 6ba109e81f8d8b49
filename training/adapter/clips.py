"""The clips that hearing is trained with, by voices of the half to train with."""

import functools
import random
from collections.abc import Sequence
from enum import Enum

from training.acoustics import Half
from training.acoustics.clips import Clip, espeak_manner
from training.acoustics.voices import PIPER, espeak_voices, kokoro_voices
from training.adapter.texts import TESTED, command, talk
from training.spotter import clips as of_spotter
from training.spotter.texts import ALIKE, CHAT

NATURAL, SPEEDS = 2_600, (0.85, 0.95, 1.0, 1.1, 1.2)
COMMANDS_SHARE, NATIVES_SHARE = 0.62, 0.6
"""Of what Kokoro says for this alone: commands, and what natives of English say."""
SPOTTER_CLIPS = 2_000
"""So many of what Kokoro says for the spotter."""
ESPEAK, ESPEAK_READINGS, ESPEAK_STOPS, PIPER_COMMANDS = 1_100, 500, 900, 260
_LONG = 60


class Kind(Enum):
    """What is said, and which share of what is learnt it is."""

    TALK = 0.48
    COMMAND = 0.34
    STOP = 0.18


def kind_of(clip: Clip) -> Kind:
    """Stop words and what sounds like them; talk; what else robots are asked."""
    if clip.word or clip.text in _all_alike():
        return Kind.STOP
    known = clip.text in CHAT or len(clip.text) > _LONG or clip.text in _all_talk()
    return Kind.TALK if known else Kind.COMMAND


@functools.cache
def _talk() -> Sequence[str]:
    return talk()


@functools.cache
def _all_talk() -> frozenset[str]:
    return frozenset(_talk())


@functools.cache
def _all_alike() -> frozenset[str]:
    return frozenset((*ALIKE, *(clip.text for clip in of_spotter.alike_clips())))


def all_clips() -> list[Clip]:
    """Those of all engines; none says what the benchmark says."""
    found = [*natural_clips(), *espeak_clips(), *piper_clips()]
    return [clip for clip in dict.fromkeys(found) if clip.text not in TESTED]


def natural_clips() -> list[Clip]:
    """Kokoro's voices, those of other languages with their accent."""
    rng, voices = random.Random(77), kokoro_voices(Half.TRAIN)
    natives = [voice for voice in voices if voice.partition(":")[2][0] in "ab"]

    found: list[Clip] = []
    while len(found) < NATURAL:
        voice = rng.choice(natives if rng.random() < NATIVES_SHARE else voices)
        text = _text(rng, COMMANDS_SHARE)
        if text not in TESTED:
            found.append(Clip(voice, text, speed=rng.choice(SPEEDS)))
    said = [*of_spotter.kokoro_clips(), *of_spotter.clips_after_words()]
    beside = [clip for clip in said if clip.engine == "kokoro"]
    alike = [clip for clip in of_spotter.alike_clips() if clip.engine == "kokoro"]
    return [*found, *rng.sample(beside, SPOTTER_CLIPS), *alike]


def espeak_clips() -> list[Clip]:
    """Plain, and at once."""
    rng, voices = random.Random(5), espeak_voices(Half.TRAIN)

    def one() -> Clip:
        text = _text(rng, 0.45)
        manner = espeak_manner(rng, 125, 220)
        return Clip(rng.choice(voices), text, **manner)

    stops = rng.sample(of_spotter.espeak_clips(), ESPEAK_STOPS)
    return [
        *(one() for _ in range(ESPEAK)),
        *of_spotter.reading_clips(ESPEAK_READINGS),
        *(clip for clip in stops if kind_of(clip) is Kind.STOP),
    ]


def piper_clips() -> list[Clip]:
    """The robot's own voice."""
    rng = random.Random(6)
    said = dict.fromkeys(command(rng) for _ in range(PIPER_COMMANDS))
    return [*(Clip(PIPER, text) for text in said), *rng.sample(of_spotter.piper_clips(), 100)]


def _text(rng: random.Random, commands: float) -> str:
    """A command, with this likelihood, or talk."""
    return command(rng) if rng.random() < commands else rng.choice(_talk())
