"""Ears for the benchmark of stop words: what they hear of words in sound, and of sound without."""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.hearing.stop_words.sounds import (
    LEVELS_DB,
    Track,
    at_speed,
    noise_of,
    responses,
    tracks,
)
from edgevox.models import locate
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.noise_floor import NoiseFloor
from edgevox.voice.stop_spotter.network import (
    ENCODER,
    SAMPLES,
    Floats,
    StopEncoder,
    StopWeights,
    likelihoods,
)
from edgevox.voice.stop_spotter.spotter import (
    LEAST_ODDS,
    LOOKED_AT,
    LOOKS_EVERY,
    SecondLikelihood,
    SecondLook,
    StopJudge,
)
from edgevox.voice.vad import SileroVad, VoiceDetector
from edgevox.voice.word_detection import WakeSleep
from training.acoustics import Half
from training.acoustics.clips import Clip
from training.acoustics.mixing import at_level, mixed
from training.acoustics.noises import kinds
from training.acoustics.rooms import in_room

LEAD_S, TAIL_S = 1.2, 0.9
SOONEST_S, WORD_S, PATIENCE_S = 0.1, 0.8, 0.5
"""After the beginning of a clip, before the end of the word that ends it, and after it: a stop at
another time has not heard the word.
"""
SHARES = {"speech": 0.62, "speech in noise": 0.18, "babble": 0.1, "noise": 0.1}
"""Of what is heard without a stop word."""
_TOGETHER = 32
"""Looks that the encoder is given at once."""


@dataclass(frozen=True, slots=True)
class Listened:
    """What a spotter looked at in a sound: by frame how likely each word is, and when it slept.

    `own` is the same for the words of another language; `again` keeps, by frame, what a second look
    told. `voices` are the probabilities that there is one.
    """

    sound: Samples
    likely: Mapping[int, Floats]
    own: Mapping[int, Floats]
    awake: Sequence[bool]
    voices: Sequence[float]
    again: dict[int, float] = field(default_factory=dict)


class Ears:
    """Hears whole sounds at once, as a `StopSpotter` hears them frame by frame, but sooner done.

    `own` are the weights of the language that is spoken, if there are some and it is not English.
    """

    def __init__(
        self,
        encoder: StopEncoder,
        weights: StopWeights,
        second: SecondLikelihood | None,
        vad: VoiceDetector | None = None,
        own: StopWeights | None = None,
    ) -> None:
        self.encoder = encoder
        self.weights = weights
        self.own = own
        self.second = second
        self.word = ""
        self._vad = vad or SileroVad()

    def looks(self, sound: Samples) -> Listened:
        """What it looks at in a sound; there was silence before."""
        voices = self._voices(sound)
        awake = _awake(sound, voices)
        at = np.flatnonzero(awake)[LOOKS_EVERY - 1 :: LOOKS_EVERY]
        heard = np.concatenate([np.zeros(SAMPLES, np.int16), sound])
        likely: dict[int, Floats] = {}
        own: dict[int, Floats] = {}
        for first in range(0, len(at), _TOGETHER):
            some = at[first : first + _TOGETHER]
            ends = (SAMPLES + (some + 1) * FRAME_SAMPLES).tolist()
            encoded = self.encoder.of([heard[end - SAMPLES : end] for end in ends])
            likely |= zip(some.tolist(), likelihoods(self.weights, encoded), strict=True)
            if self.own:
                own |= zip(some.tolist(), likelihoods(self.own, encoded), strict=True)
        return Listened(sound, likely, own, awake, voices)

    def judged(
        self, looks: Listened, threshold: float | None = None, least_odds: float = LEAST_ODDS
    ) -> Iterator[float]:
        """When it stops, in seconds of the sound: by a threshold where nobody looks again, else by
        these odds.
        """
        judge = StopJudge(self.weights, threshold, least_odds)
        other = StopJudge(self.own) if self.own else None
        judges, noise = [judge, other] if other else [judge], NoiseFloor()
        for frame, awake in enumerate(looks.awake):
            noise.push(_frame(looks.sound, frame), looks.voices[frame])
            if not awake:
                for one in judges:
                    one.rest()
                continue
            resting = any(one.resting for one in judges)
            again = partial(self._looked_again, looks, frame) if self.second else None
            said = judge.said(looks.likely.get(frame), again, lambda: noise.stands_out_db)
            own = other is not None and other.said(looks.own.get(frame))
            if (said or own) and not resting:
                self.word = judge.word if said or not other else other.word
                yield (frame + 1) * FRAME_S

    def stops(self, sound: Samples) -> Iterator[float]:
        """When it stops, in seconds of the sound."""
        return self.judged(self.looks(sound))

    def _looked_again(self, looks: Listened, frame: int) -> float:
        if frame not in looks.again:
            before = np.concatenate([np.zeros(LOOKED_AT, np.int16), looks.sound])
            end = LOOKED_AT + (frame + 1) * FRAME_SAMPLES
            looks.again[frame] = self.second(before[end - LOOKED_AT : end])
        return looks.again[frame]

    def _voices(self, sound: Samples) -> list[float]:
        self._vad.reset()
        count = sound.size // FRAME_SAMPLES
        return [self._vad.probability(_frame(sound, number)) for number in range(count)]


def _awake(sound: Samples, voices: Sequence[float]) -> list[bool]:
    sleep = WakeSleep()
    return [bool(sleep.push(_frame(sound, number), one)) for number, one in enumerate(voices)]


def _frame(sound: Samples, number: int) -> Samples:
    return sound[number * FRAME_SAMPLES : (number + 1) * FRAME_SAMPLES]


def ears_of(weights: StopWeights, own: StopWeights | None = None) -> Ears:
    """With these weights, on the encoder that they were trained for."""
    folder = locate(ENCODER)
    second = SecondLook(folder)
    return Ears(StopEncoder(folder, weights.added), weights, second.likelihood, own=own)


@dataclass(frozen=True, slots=True)
class Spot:
    """A clip in sound, from where in it to where; the word in it ends it, or is within."""

    clip: Clip
    noise: str
    sound: Samples
    begins_s: float
    ends_s: float

    def heard(self, stops: Iterator[float]) -> float | None:
        """How long after the word's end it was heard; None if it was not."""
        first_s = self.begins_s + SOONEST_S
        if not self.clip.within:
            first_s = max(first_s, self.ends_s - WORD_S)
        found = [when for when in stops if first_s <= when <= self.ends_s + PATIENCE_S]
        return found[0] - self.ends_s if found else None


@dataclass(frozen=True, slots=True)
class Trial:
    """A word in a sound, and how long after its end it was heard; None if it was missed."""

    clip: Clip
    noise: str
    sound: Samples
    delay_s: float | None

    @property
    def heard(self) -> bool:
        return self.delay_s is not None


def spots(half: Half, clips: Sequence[Clip], snr_db: float | None) -> Iterator[Spot]:
    """Every clip once, in quiet or in some room and noise of this part."""
    rng = np.random.default_rng(29)
    for clip in clips:
        said = at_speed(clip.samples, rng.uniform(0.92, 1.08))
        kind, sound = among(said, half, snr_db, rng)
        lead = int(LEAD_S * RATE_HZ)
        yield Spot(clip, kind, sound, lead / RATE_HZ, (lead + said.size) / RATE_HZ)


def among(
    said: NDArray[Any], half: Half, snr_db: float | None, rng: np.random.Generator
) -> tuple[str, Samples]:
    """What is said, `LEAD_S` after the beginning, in quiet or in some room and noise of this part:
    which noise, and what is heard.
    """
    kind = kinds(half)[rng.integers(len(kinds(half)))]
    lead, tail = int(LEAD_S * RATE_HZ), int(TAIL_S * RATE_HZ)
    track = np.concatenate([np.zeros(lead), said, np.zeros(tail)])
    if snr_db is not None:
        rooms = responses(half)
        track = in_room(track, rooms[rng.integers(len(rooms))])[: track.size]
        around = noise_of(kind, int(rng.integers(40)), half)
        start = rng.integers(around.size - track.size)
        track = mixed(track, around[start : start + track.size], snr_db)
    else:
        kind, track = "quiet", track + rng.normal(0, 3, track.size)
    return kind, at_level(track, rng.uniform(*LEVELS_DB))


def trials(half: Half, ears: Ears, clips: Sequence[Clip], snr_db: float | None) -> Iterator[Trial]:
    """What it hears of them."""
    for spot in spots(half, clips, snr_db):
        yield Trial(spot.clip, spot.noise, spot.sound, spot.heard(ears.stops(spot.sound)))


@dataclass(frozen=True, slots=True)
class Stretch:
    """Sound without a stop word: what comes one after the other, and when each of it ends."""

    tracks: tuple[Track, ...]
    ends_s: tuple[float, ...]
    sound: Samples

    @property
    def hours(self) -> float:
        return self.sound.size / RATE_HZ / 3600

    @property
    def clips(self) -> list[Clip]:
        """What is said in it."""
        return [track.clip for track in self.tracks if track.clip]

    def note(self, when_s: float) -> str:
        """What is heard at this time."""
        number = min(int(np.searchsorted(self.ends_s, when_s)), len(self.tracks) - 1)
        return self.tracks[number].note


def stretches(half: Half, what: str, hours: float) -> Iterator[Stretch]:
    """So many hours of it."""
    return joined(tracks(half, what, 3600 * hours))


def joined(tracks: Iterable[Track], together: int = 30) -> Iterator[Stretch]:
    """Some tracks at a time: what one ends with is there when the next begins.

    Sound is cut to whole frames.
    """
    told = iter(tracks)
    while some := tuple(itertools.islice(told, together)):
        sound = np.concatenate([track.sound for track in some])
        ends = np.cumsum([track.sound.size for track in some]) / RATE_HZ
        whole = sound[: sound.size // FRAME_SAMPLES * FRAME_SAMPLES]
        yield Stretch(some, tuple(float(end) for end in ends), whole)


@dataclass(frozen=True, slots=True)
class FalseStops:
    """Hours heard without a stop word, whose clips they were, and what was taken for a stop."""

    hours: float
    clips: tuple[Clip, ...]
    wrong: tuple[str, ...]


def false_stops(ears: Ears, what: str, heard: Iterable[Stretch]) -> FalseStops:
    """What it does in what is heard."""
    heard_h, wrong, clips = 0.0, [], []
    for stretch in heard:
        heard_h += stretch.hours
        clips += stretch.clips
        wrong += [
            f"{what}: {stretch.note(when)} (took it for {ears.word})"
            for when in ears.stops(stretch.sound)
        ]
    return FalseStops(heard_h, tuple(clips), tuple(wrong))
