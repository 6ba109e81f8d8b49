"""What the benchmark of stop words lets be heard: words, and hours of sound without them."""

import functools
import itertools
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples
from training.acoustics import Half
from training.acoustics.clips import Clip, espeak_manner
from training.acoustics.mixing import at_level, mixed
from training.acoustics.noises import kinds, noise
from training.acoustics.rooms import in_room, rooms
from training.acoustics.sentences import sentences
from training.acoustics.voices import espeak_voices, kokoro_voices

SAID = {
    "stop": ("Stop!", "Stop.", "Please stop.", "No, stop!", "Robot, stop!", "Hey, stop!",
             "I said stop!", "Everybody stop!"),
    "halt": ("Halt!", "Halt.", "Please halt.", "No, halt!", "Robot, halt!", "Hey, halt!",
             "I said halt!", "Everybody halt!"),
    "freeze": ("Freeze!", "Freeze.", "Please freeze.", "No, freeze!", "Robot, freeze!",
               "Hey, freeze!", "I said freeze!", "Everybody freeze!"),
}  # fmt: skip
"""Texts that end with the stop word."""
SAID_WITHIN = {
    "stop": ("Stop moving!", "Stop right there!"),
    "halt": ("Halt now!", "Halt right there!"),
    "freeze": ("Freeze now!", "Freeze right there!"),
}
"""Texts that go on after it."""
SPEEDS = {Half.HELD_OUT: (0.85, 1.0, 1.2), Half.TUNING: (1.0,)}
"""How fast Kokoro's voices say each of them."""
ALIKE = (
    "shop", "top", "stuff", "step", "drop", "stock", "spot", "start", "salt", "hall", "fault",
    "hold", "halter", "freezer", "breeze", "please", "three", "fleas", "hop", "heart", "vault",
    "star",
)  # fmt: skip
"""Words that sound like a stop word."""
_AROUND = ("The {} is here.", "{}.", "Where is the {}?")
TALK = {
    Half.HELD_OUT: {"espeak": 3_600, "kokoro": 360},
    Half.TUNING: {"espeak": 1_200, "kokoro": 120},
}
"""Clips without a stop word, by engine."""
_KOKOROS_SHARE = 0.2
LEVELS_DB = (-38.0, -18.0)


def words(half: Half) -> list[Clip]:
    """Who says which stop word: all of Kokoro's voices all texts, at all speeds."""
    ends = [(word, text, False) for word, texts in SAID.items() for text in texts]
    within = [(word, text, True) for word, texts in SAID_WITHIN.items() for text in texts]
    found = [
        Clip(voice, text, word, inside, speed=speed)
        for speed in SPEEDS[half]
        for voice in kokoro_voices(half)
        for word, text, inside in (*ends, *within)
    ]
    rng = random.Random(3)
    for voice in espeak_voices(half):
        for word in SAID:
            some = [one for one in (*ends, *within) if one[0] == word]
            for _, text, inside in rng.sample(some, 2):
                found.append(Clip(voice, text, word, inside, **espeak_manner(rng)))
    return found


def talk(half: Half) -> list[Clip]:
    """Who says what without a stop word, in an order in which all voices come soon."""
    rng, known = random.Random(31), sentences(half)
    found = [
        Clip(voice, rng.choice(known), speed=rng.choice(SPEEDS[half]))
        for voice in _in_turn(kokoro_voices(half), TALK[half]["kokoro"])
    ]
    return found + [
        Clip(voice, rng.choice(known), **espeak_manner(rng))
        for voice in _in_turn(espeak_voices(half), TALK[half]["espeak"])
    ]


def alike(half: Half) -> list[Clip]:
    """Who says which word that sounds like a stop word."""
    rng, found = random.Random(37), []
    for voice in kokoro_voices(half):
        found += [Clip(voice, _around(rng, word)) for word in ALIKE]
    for voice in espeak_voices(half):
        found += [Clip(voice, _around(rng, word)) for word in rng.sample(ALIKE, 8)]
    return found


def clips(half: Half) -> list[Clip]:
    """All that is to be spoken, what is needed most first; what sounds alike is for the test."""
    return [*words(half), *(alike(half) if half is Half.HELD_OUT else ()), *talk(half)]


def _in_turn(voices: Sequence[str], number: int) -> Iterator[str]:
    return itertools.islice(itertools.cycle(voices), number)


def _around(rng: random.Random, word: str) -> str:
    text = rng.choice(_AROUND).format(word)
    return text[0].upper() + text[1:]


_made: dict[tuple[str, int, Half], NDArray[np.float32]] = {}


def noise_of(kind: str, seed: int, half: Half) -> NDArray[np.float32]:
    """Eight seconds of it, made once."""
    key = (kind, seed % 6, half)
    if key not in _made:
        _made[key] = noise(kind, 8.0, 7_000 + seed % 6, half).astype(np.float32)
    return _made[key]


@functools.cache
def responses(half: Half) -> list[NDArray[np.float64]]:
    """What the rooms of this part make of a click."""
    return [room.response() for room in rooms(half, 20)]


def at_speed(sound: Samples, step: float) -> NDArray[np.float64]:
    """The same, faster or slower, pitch with it."""
    n = int(sound.size / step)
    return np.interp(np.arange(n) * step, np.arange(sound.size), sound.astype(np.float64))


@dataclass(frozen=True, slots=True)
class Track:
    """Sound without a stop word: what is in it in words, and the clip, if one is."""

    note: str
    clip: Clip | None
    sound: Samples


def tracks(half: Half, what: str, seconds: float) -> Iterator[Track]:
    """What is said without a stop word, until it is enough.

    A clip comes again, at another speed and elsewhere, only when all of its engine have come.
    """
    rng, done = np.random.default_rng((31, len(what))), 0.0
    echoes = responses(half)
    said = _shuffled(rng, talk(half))
    while done < seconds:
        clip = None
        if what in ("babble", "noise"):
            some = [kind for kind in kinds(half) if (kind == "babble") == (what == "babble")]
            note = some[rng.integers(len(some))]
            track = noise(note, 20.0, int(rng.integers(1_000, 900_000)), half)
        else:
            clip = next(said["kokoro" if rng.random() < _KOKOROS_SHARE else "espeak"])
            note = f"{clip.voice} {clip.text}"
            track = at_speed(clip.samples, rng.uniform(0.9, 1.12))
            if rng.random() < 0.6:
                track = in_room(track, echoes[rng.integers(len(echoes))])
        if what == "speech in noise":
            kind, track = in_noise(rng, track, half)
            note = f"{kind} {note}"
        sound = before_a_pause(rng, track)
        done += sound.size / RATE_HZ
        yield Track(note, clip, sound)


def in_noise(
    rng: np.random.Generator, track: NDArray[np.float64], half: Half
) -> tuple[str, NDArray[np.float64]]:
    """Some noise of this part, and the sound in it, at 0 to 15 dB."""
    kind = kinds(half)[rng.integers(len(kinds(half)))]
    return kind, mixed(track, noise_of(kind, int(rng.integers(40)), half), rng.uniform(0, 15))


def before_a_pause(rng: np.random.Generator, track: NDArray[np.float64]) -> Samples:
    """The sound at some level, and a nearly silent pause."""
    pause = rng.normal(0, 1e-3 * np.abs(track).max() + 1, int(rng.uniform(0.1, 0.5) * RATE_HZ))
    return at_level(np.concatenate([track, pause]), rng.uniform(*LEVELS_DB))


def _shuffled(rng: np.random.Generator, clips: Sequence[Clip]) -> dict[str, Iterator[Clip]]:
    """For each engine its clips, in a new order every time round."""

    def rounds(some: list[Clip]) -> Iterator[Clip]:
        while True:
            yield from (some[i] for i in rng.permutation(len(some)))

    engines = {clip.engine for clip in clips}
    return {engine: rounds([c for c in clips if c.engine == engine]) for engine in engines}
