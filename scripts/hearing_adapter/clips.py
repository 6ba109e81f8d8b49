"""The clips that hearing is trained with, by voices of the half to train with."""

import functools
import random
from collections.abc import Callable
from enum import Enum

from acoustics import Half
from acoustics.clips import Clip
from acoustics.voices import PIPER, espeak_voices, kokoro_voices
from stop_spotter import clips as of_spotter
from stop_spotter.texts import ALIKE, CHAT

from hearing_adapter.texts import TESTED, command, talk

NATURAL, SPEEDS = 2_600, (0.85, 0.95, 1.0, 1.1, 1.2)
"""So many of Kokoro's, of which natives of English say six of ten."""
COMMANDS_SHARE = 0.62
SPOTTER_CLIPS = 2_000
"""So many of what Kokoro says for the spotter."""
ESPEAK, ESPEAK_READINGS, ESPEAK_STOPS, PIPER_COMMANDS = 1_100, 500, 900, 260
_LONG = 60


class Kind(Enum):
    """What is said, and which share of what is learnt it is."""

    TALK = 0.5
    COMMAND = 0.36
    STOP = 0.14


def kind_of(clip: Clip) -> Kind:
    """Stop words and what sounds like them; talk; what else robots are asked."""
    if clip.word or clip.text in ALIKE:
        return Kind.STOP
    known = clip.text in CHAT or len(clip.text) > _LONG or clip.text in _talk()
    return Kind.TALK if known else Kind.COMMAND


@functools.cache
def _talk() -> frozenset[str]:
    return frozenset(talk())


def all_clips() -> list[Clip]:
    """Those of all engines; none says what the benchmark says."""
    found = [*natural_clips(), *espeak_clips(), *piper_clips()]
    return [clip for clip in dict.fromkeys(found) if clip.text not in TESTED]


def natural_clips() -> list[Clip]:
    """Kokoro's voices, those of other languages with their accent."""
    rng, voices = random.Random(77), kokoro_voices(Half.TRAIN)
    natives = [voice for voice in voices if voice.partition(":")[2][0] in "ab"]

    def one(text: str) -> Clip:
        voice = rng.choice(natives if rng.random() < 0.6 else voices)
        return Clip(voice, text, speed=rng.choice(SPEEDS))

    said = [*of_spotter.kokoro_clips(), *of_spotter.clips_after_words()]
    beside = [clip for clip in said if clip.engine == "kokoro"]
    return [*_some(NATURAL, COMMANDS_SHARE, rng, one), *rng.sample(beside, SPOTTER_CLIPS)]


def espeak_clips() -> list[Clip]:
    """Plain, and at once."""
    rng, voices = random.Random(5), espeak_voices(Half.TRAIN)

    def one(text: str) -> Clip:
        pitch, speed = rng.randint(20, 85), rng.randint(125, 220)
        return Clip(rng.choice(voices), text, pitch=pitch, words_a_minute=speed)

    stops = rng.sample(of_spotter.espeak_clips(), ESPEAK_STOPS)
    return [
        *_some(ESPEAK, 0.45, rng, one),
        *of_spotter.reading_clips(ESPEAK_READINGS),
        *(clip for clip in stops if kind_of(clip) is Kind.STOP),
    ]


def piper_clips() -> list[Clip]:
    """The robot's own voice."""
    rng = random.Random(6)
    said = dict.fromkeys(command(rng) for _ in range(PIPER_COMMANDS))
    return [*(Clip(PIPER, text) for text in said), *rng.sample(of_spotter.piper_clips(), 100)]


def _some(
    number: int, commands: float, rng: random.Random, one: Callable[[str], Clip]
) -> list[Clip]:
    """So many, of which a share are commands."""
    others = talk()
    texts = (command(rng) if rng.random() < commands else rng.choice(others) for _ in range(number))
    return [one(text) for text in texts]
