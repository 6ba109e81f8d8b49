"""Examples to learn from: clips among silence and other speech, in rooms and noise, as features."""

from dataclasses import dataclass

import numpy as np
from acoustics import Half
from acoustics.mixing import voiced_power
from acoustics.noises import kinds, noise
from acoustics.rooms import rooms
from numpy.typing import NDArray

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ
from edgevox.voice.stop_features import (
    HOP_SAMPLES,
    ROWS,
    features_of,
)
from edgevox.voice.stop_network import STRIDE
from stop_spotter import random_states, texts

Wave = NDArray[np.float32]

LEAD_FRAMES, FRAMES = 16, 64
"""Frames of sound before an example, which the slow averages of its features need, and of it."""
STEPS = FRAMES * ROWS // STRIDE
IGNORED, WITHIN = -1, -2
"""Labels of steps that are not judged, and of those one of which should hear the word."""
HEARD_S = 0.15
"""For so long after its end a word should be heard."""
_AFTER_S = 0.5
_FFT = 54_000  # more than an example and a response
_STEP_S = STRIDE * HOP_SAMPLES / RATE_HZ


@dataclass(frozen=True, slots=True)
class Sound:
    """A clip in memory: `word` counts from 1, 0 for none."""

    samples: NDArray[np.int16]
    word: int
    within: bool
    weight: float = 1.0


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

    def make(self) -> tuple[NDArray[np.float16], NDArray[np.int8], int]:
        """Features (rows, bands), labels (steps,), and the word: 0 for none."""
        rng = self._rng
        word = int(rng.integers(1, len(self._words))) if rng.random() < 0.36 else 0
        total = (LEAD_FRAMES + FRAMES) * FRAME_SAMPLES
        track = np.zeros(total, np.float32)
        labels = np.zeros(STEPS, np.int8)
        sound = self._sound(word)
        if word:
            clip = self._varied(sound)
            least = LEAD_FRAMES * FRAME_SAMPLES + clip.size // 2
            most = max(1, total - clip.size - int(HEARD_S * RATE_HZ))
            start = int(rng.integers(min(least, most - 1), most))
            _put(track, clip, start)
            end_s = (start + clip.size) / RATE_HZ - LEAD_FRAMES * FRAME_SAMPLES / RATE_HZ
            _label(labels, word, sound.within, clip.size / RATE_HZ, end_s)
            if rng.random() < 0.5:
                self._chatter(track, 0, start - int(rng.uniform(0.03, 0.5) * RATE_HZ))
            if rng.random() < 0.4 and not sound.within:
                begin = start + clip.size + int(rng.uniform(0.08, 0.5) * RATE_HZ)
                self._chatter(track, begin, total)
        elif rng.random() < 0.9:
            self._chatter(track, int(rng.uniform(0, 1.2) * RATE_HZ), total)
        return features_of(self._heard(track))[-FRAMES * ROWS :].astype(np.float16), labels, word

    def state(self) -> str:
        """What the next examples depend on."""
        return random_states.state_of(self._rng)

    def resume(self, state: str) -> None:
        """Go on from what `state` gave."""
        random_states.resume(self._rng, state)

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


def _label(labels: NDArray[np.int8], word: int, within: bool, said_s: float, end_s: float) -> None:
    """Which steps should hear the word, and which are not judged as they may or may not."""
    times = (np.arange(STEPS) + 1) * _STEP_S
    begin_s = end_s - said_s
    labels[(times > begin_s + 0.08) & (times <= end_s + _AFTER_S)] = IGNORED
    if within:
        labels[(times > begin_s + 0.2) & (times <= min(begin_s + 0.8, end_s + HEARD_S))] = WITHIN
    else:
        labels[(times >= end_s) & (times <= end_s + HEARD_S)] = word
