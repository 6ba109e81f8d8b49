"""Examples to learn from: clips among silence and other speech, in rooms and noise."""

from dataclasses import dataclass

import numpy as np
from acoustics import Half
from acoustics.mixing import voiced_power
from acoustics.noises import kinds, noise
from acoustics.rooms import rooms
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stop_encoder import SAMPLES
from stop_spotter import texts

Wave = NDArray[np.float32]

TRACK_S = 3.2
"""How long an example is; what looks at it has all of what it looks at."""
IGNORED = -1
"""The label of a look that is not judged: it may hear the word or not."""
HEARD_S, HEARD_WITHIN_S = 0.24, (0.5, 0.75)
"""For so long after its end a word is to be heard; after its beginning, where more is said."""
BEFORE_S, PAST_S = 0.05, 0.5
"""A look up to so soon after a word begins does not hear it, nor one so long after its end: a word
is to be heard once, though it is seen for longer.
"""
_LEAD_S, _TAIL_S = 0.6, 0.35
_FIRST_S = SAMPLES / RATE_HZ + 0.005
_WITH_WORD = 0.5
_FFT = 72_000  # more than an example and a response


@dataclass(frozen=True, slots=True)
class Sound:
    """A clip in memory: `word` counts from 1, 0 for none."""

    samples: NDArray[np.int16]
    word: int
    within: bool
    weight: float = 1.0


@dataclass(frozen=True, slots=True)
class Example:
    """Sound of `TRACK_S`, and the stop word in it, if any, from when to when."""

    sound: Samples
    word: int = 0
    within: bool = False
    begins_s: float = 0.0
    ends_s: float = 0.0

    def label(self, when_s: float) -> int:
        """What a look at this time is to find: a word, 0 for none, or `IGNORED`."""
        if not self.word:
            return 0
        first, last = self._heard_s
        if first <= when_s <= last:
            return self.word
        before, after = when_s < self.begins_s + BEFORE_S, when_s > self.ends_s + PAST_S
        return 0 if before or after else IGNORED

    def looked_at(self, when_s: float) -> Samples:
        """What a look at this time sees."""
        end = min(int(when_s * RATE_HZ), self.sound.size)
        return self.sound[end - SAMPLES : end]

    def times(self, rng: np.random.Generator) -> list[float]:
        """When to look at it, where few looks are enough: mostly when the word is to be heard."""
        latest = self.sound.size / RATE_HZ
        anywhere = [float(when) for when in rng.uniform(_FIRST_S, latest, 2 if self.word else 3)]
        if not self.word:
            return anywhere
        said = [
            *rng.uniform(*self._heard_s, 2),
            self.ends_s + rng.uniform(PAST_S, SAMPLES / RATE_HZ),
        ]
        return [*anywhere, *(float(np.clip(when, _FIRST_S, latest)) for when in said)]

    @property
    def _heard_s(self) -> tuple[float, float]:
        """From when to when the word is to be heard."""
        if self.within:
            soonest, latest = HEARD_WITHIN_S
            return self.begins_s + soonest, self.begins_s + latest
        return self.ends_s, self.ends_s + HEARD_S


class Examples:
    """Makes examples of these sounds."""

    def __init__(self, sounds: list[Sound], seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._words = [
            [s for s in sounds if s.word == number] for number in range(len(texts.WORDS) + 1)
        ]
        self._odds = [
            np.array([s.weight for s in some]) / sum(s.weight for s in some) for some in self._words
        ]
        self._rooms = [room.response().astype(np.float32) for room in rooms(Half.TRAIN, 60)]
        self._noises = [
            noise(kind, 8.0, 100 * seed + number, Half.TRAIN).astype(np.float32)
            for kind in kinds(Half.TRAIN)
            for number in range(6)
        ]

    def make(self) -> Example:
        """The next one."""
        rng = self._rng
        word = int(rng.integers(1, len(self._words))) if rng.random() < _WITH_WORD else 0
        track = np.zeros(int(TRACK_S * RATE_HZ), np.float32)
        sound = self._sound(word)
        if word:
            clip = self._varied(sound)
            least = int(_LEAD_S * RATE_HZ)
            start = int(
                rng.integers(least, max(least + 1, track.size - clip.size - int(_TAIL_S * RATE_HZ)))
            )
            end = start + clip.size
            _put(track, clip, start)
            if rng.random() < 0.5:
                self._chatter(track, 0, start - int(rng.uniform(0.03, 0.5) * RATE_HZ))
            if rng.random() < 0.4 and not sound.within:
                self._chatter(track, end + int(rng.uniform(0.06, 0.5) * RATE_HZ), track.size)
            return Example(self._heard(track), word, sound.within, start / RATE_HZ, end / RATE_HZ)
        if rng.random() < 0.95:
            self._chatter(track, int(rng.uniform(0, 1.2) * RATE_HZ), track.size)
        return Example(self._heard(track))

    def _sound(self, word: int) -> Sound:
        some = self._words[word]
        return some[self._rng.choice(len(some), p=self._odds[word])]

    def _varied(self, sound: Sound) -> Wave:
        """Faster or slower, as a whole: pitch goes with it; and at a loudness of 1."""
        step = self._rng.uniform(0.85, 1.18)
        n = int(sound.samples.size / step)
        changed = np.interp(np.arange(n) * step, np.arange(sound.samples.size), sound.samples)
        return (changed / np.sqrt(voiced_power(changed) + 1e-9)).astype(np.float32)

    def _chatter(self, track: Wave, begin: int, end: int) -> None:
        """Other speech, up to here; what ends before does not begin with the clip's beginning."""
        rng, at = self._rng, begin
        while at < end:
            clip = self._varied(self._sound(0))
            if rng.random() < 0.3:
                clip = clip[int(rng.uniform(0, 0.7) * clip.size) :]
            if end < track.size:
                clip = clip[-(end - at) :] if clip.size > end - at else clip
            _put(track, clip * 10 ** (rng.uniform(-6, 3) / 20), at)
            at += clip.size + int(rng.uniform(0.02, 0.5) * RATE_HZ)

    def _heard(self, track: Wave) -> NDArray[np.int16]:
        """In a room, by a microphone of some colour, with noise, at some level."""
        rng = self._rng
        size = _FFT
        spectrum = np.fft.rfft(track, size)
        if rng.random() < 0.65:
            response = self._rooms[rng.integers(len(self._rooms))]
            if rng.random() < 0.3:
                soon = np.arange(response.size, dtype=np.float32) / np.float32(
                    rng.uniform(400, 3000)
                )
                response = response * np.exp(-soon)
                response /= np.sqrt(np.sum(response**2))
            spectrum *= np.fft.rfft(response, size)
        spectrum *= self._colour(size)
        speech = np.fft.irfft(spectrum, size)[: track.size]
        level = 10 ** (rng.uniform(-42, -12) / 20)
        speech *= level / np.sqrt(voiced_power(speech) + 1e-9) if np.any(track) else 0
        kind = rng.random()
        if kind < 0.2:
            rustle = 10 ** (rng.uniform(-90, -60) / 20)
        else:
            rustle = level / 10 ** (rng.uniform(-1, 25) / 20)
        heard = speech + rustle * self._noise(track.size)
        if rng.random() < 0.15:
            heard = heard + rustle * rng.uniform(0.3, 1) * self._noise(track.size)
        return np.clip(32768 * heard, -32768, 32767).astype(np.int16)

    def _colour(self, size: int) -> Wave:
        """A tilt and a hump, as microphones and mouths differ."""
        rng = self._rng
        octaves = np.log2(np.maximum(np.fft.rfftfreq(513 * 2, 1 / RATE_HZ), 60) / 1000)
        hump = rng.uniform(-6, 6) * np.exp(-(((octaves - rng.uniform(-2, 3)) / 0.7) ** 2))
        coarse = 10 ** ((rng.uniform(-3, 3) * octaves + hump) / 20)
        fine = np.linspace(0, coarse.size - 1, size // 2 + 1)
        return np.interp(fine, np.arange(coarse.size), coarse).astype(np.float32)

    def _noise(self, n: int) -> Wave:
        """Some of it, from somewhere, now and then with a change of loudness."""
        rng = self._rng
        whole = self._noises[rng.integers(len(self._noises))]
        start = rng.integers(whole.size - n)
        some = whole[start : start + n]
        if rng.random() < 0.3:
            some = some * np.interp(
                np.arange(n), np.linspace(0, n, 5), 10 ** (rng.uniform(-10, 4, 5) / 20)
            )
        return some[::-1] if rng.random() < 0.3 else some


def _put(track: Wave, clip: Wave, at: int) -> None:
    """Add a clip to a track; what does not fit is left out."""
    begin, end = max(0, at), min(track.size, at + clip.size)
    if end > begin:
        track[begin:end] += clip[begin - at : end - at]
