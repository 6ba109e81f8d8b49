"""Utterances to learn from: what was said, as it was said and as a microphone hears it."""

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from acoustics import Half
from acoustics.clips import Clip
from acoustics.noises import BABBLE, kinds, noise
from whisper_training.surroundings import Surroundings, Wave, varied

from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.whisper import SHORT_S
from hearing_adapter.clips import kind_of
from hearing_adapter.texts import command, written

NOTHING_SHARE, TWO_SHARE, SOON_SHARE = 0.05, 0.06, 0.15
"""Of the utterances, in which nobody speaks to it, in which two sentences are said, and of which
the words are wanted before it is known to be over.
"""
NATURAL_WEIGHT = 4.0
"""Kokoro's clips are drawn so many times as often as others."""
ROOM_SHARE, QUIET_SHARE, SNR_DB = 0.8, 0.12, (1, 20)
NOISE_S, OF_A_KIND, NATURAL_BABBLES = 16.0, 4, 8
CLEAN_DB, FLOOR_DB = -26.0, -80.0


@dataclass(frozen=True, slots=True)
class Utterance:
    """A sound as it was said and as it is heard, equally long; no text if nobody spoke."""

    said: Samples
    heard: Samples
    text: str


class Utterances:
    """Makes utterances of these clips."""

    def __init__(self, clips: Sequence[Clip], seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._clips = clips
        self._sounds = [clip.samples for clip in clips]
        self._odds = odds_of(clips)
        self._surroundings = Surroundings(
            self._rng, self._noises(seed), ROOM_SHARE, QUIET_SHARE, SNR_DB
        )

    def make(self) -> Utterance:
        """The next one: noise alone, a sentence, or two."""
        rng = self._rng
        if rng.random() < NOTHING_SHARE:
            sound = self._surroundings.heard(_silence(rng.uniform(0.8, 4)))
            return Utterance(sound, sound, "")
        while True:
            text, parts = self._sentence()
            if rng.random() < TWO_SHARE:
                second, more = self._sentence()
                text, parts = f"{text} {second}", [*parts, _silence(rng.uniform(0.1, 0.5)), *more]
            soon = rng.random() < SOON_SHARE
            after = _silence(rng.uniform(0.02, 0.2)) if soon else self._around()
            track = np.concatenate([self._around(), *parts, after])
            if track.size <= SHORT_S * RATE_HZ:
                return Utterance(_clean(track, rng), self._surroundings.heard(track), text)

    def _sentence(self) -> tuple[str, list[Wave]]:
        at = self._rng.choice(len(self._clips), p=self._odds)
        return written(self._clips[at].text), [varied(self._sounds[at], self._rng)]

    def _around(self) -> Wave:
        """What is before and after it: mostly little, now and then more."""
        rng = self._rng
        return _silence(rng.uniform(0.1, 0.6) if rng.random() < 0.8 else rng.uniform(0.6, 1.6))

    def _noises(self, seed: int) -> list[Wave]:
        """Those to train with, babble twice, and natural voices that talk at once."""
        every = [*kinds(Half.TRAIN), BABBLE]
        computed = [
            noise(kind, NOISE_S, 100 * seed + number, Half.TRAIN).astype(np.float32)
            for number, kind in enumerate(every * OF_A_KIND)
        ]
        return [*computed, *(self._babble() for _ in range(NATURAL_BABBLES))]

    def _babble(self) -> Wave:
        rng, whole = self._rng, _silence(NOISE_S)
        for _ in range(int(rng.integers(1, 6))):
            at, loud = 0, rng.uniform(0.5, 1)
            while at < whole.size:
                (clip,) = self._sentence()[1]
                some = loud * clip[: whole.size - at]
                whole[at : at + some.size] += some
                at += some.size + int(rng.uniform(0, 0.4) * RATE_HZ)
        return whole / np.sqrt(np.mean(whole**2))


def prompt(rng: random.Random, target: str) -> str:
    """What a robot may be told, as it is shown before: what was said is among it, or not."""
    some = [written(command(rng)) for _ in range(rng.randrange(3, 14))]
    if rng.random() < 0.4:
        some[rng.randrange(len(some))] = target
    return " ".join(some)


def odds_of(clips: Sequence[Clip]) -> np.ndarray:
    """How often each clip is drawn, so that each kind has its share."""
    drawn = [(kind_of(clip), NATURAL_WEIGHT if clip.engine == "kokoro" else 1.0) for clip in clips]
    whole: Counter = Counter()
    for kind, weight in drawn:
        whole[kind] += weight
    odds = np.array([kind.value * weight / whole[kind] for kind, weight in drawn])
    return odds / odds.sum()


def _silence(seconds: float) -> Wave:
    return np.zeros(int(seconds * RATE_HZ), np.float32)


def _clean(track: Wave, rng: np.random.Generator) -> Samples:
    """At some loudness, with what any microphone rustles."""
    rustle = rng.normal(0, 10 ** (FLOOR_DB / 20), track.size)
    return np.clip(32768 * (10 ** (CLEAN_DB / 20) * track + rustle), -32768, 32767).astype(np.int16)
