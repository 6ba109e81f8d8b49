"""Utterances to learn from: what is said, before anybody hears it."""

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stt.whisper import SHORT_S
from training.acoustics.clips import Clip
from training.adapter.clips import kind_of
from training.adapter.texts import command, written
from training.whisper.tracks import Drawn, Wave, silence, varied

NOTHING_SHARE, TWO_SHARE, SOON_SHARE = 0.05, 0.06, 0.15
"""Of the utterances, in which nobody speaks to it, in which two sentences are said, and of which
the words are wanted before it is known to be over.
"""
NATURAL_WEIGHT = 4.0
"""Kokoro's clips are drawn so many times as often as others."""
NOISE_S = 16.0


@dataclass(frozen=True, slots=True)
class Utterance:
    """What is said, and its text; none of both if nobody speaks."""

    track: Wave
    text: str


class Utterances:
    """Makes utterances of these clips."""

    def __init__(self, clips: Sequence[Clip], seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._clips = clips
        self._sounds = [clip.samples for clip in clips]
        self._drawn = Drawn(odds_of(clips))

    def make(self) -> Utterance:
        """The next one: nothing, a sentence, or two."""
        rng = self._rng
        if rng.random() < NOTHING_SHARE:
            return Utterance(silence(rng.uniform(0.8, 4)), "")
        while True:
            text, parts = self._sentence()
            if rng.random() < TWO_SHARE:
                second, more = self._sentence()
                text, parts = f"{text} {second}", [*parts, silence(rng.uniform(0.1, 0.5)), *more]
            soon = rng.random() < SOON_SHARE
            after = silence(rng.uniform(0.02, 0.2)) if soon else self._around()
            track = np.concatenate([self._around(), *parts, after])
            if track.size <= SHORT_S * RATE_HZ:
                return Utterance(track, text)

    def babble(self) -> Wave:
        """Natural voices that talk at once, `NOISE_S` of them, at a root mean square of 1."""
        rng, whole = self._rng, silence(NOISE_S)
        for _ in range(int(rng.integers(1, 6))):
            at, loud = 0, rng.uniform(0.5, 1)
            while at < whole.size:
                (clip,) = self._sentence()[1]
                some = loud * clip[: whole.size - at]
                whole[at : at + some.size] += some
                at += some.size + int(rng.uniform(0, 0.4) * RATE_HZ)
        return whole / np.sqrt(np.mean(whole**2))

    def _sentence(self) -> tuple[str, list[Wave]]:
        at = self._drawn.one(self._rng)
        return written(self._clips[at].text), [varied(self._sounds[at], self._rng)]

    def _around(self) -> Wave:
        """What is before and after it: mostly little, now and then more."""
        rng = self._rng
        return silence(rng.uniform(0.1, 0.6) if rng.random() < 0.8 else rng.uniform(0.6, 1.6))


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
