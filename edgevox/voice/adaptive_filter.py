"""What of a sound is the answer of a loudspeaker and a room to another sound, learnt as both go on.

A partitioned-block frequency-domain Kalman filter: it models the way from loudspeaker to microphone
as a linear filter, and knows for every frequency how sure it is of it. So it learns fast at first
and where only the loudspeaker is heard, and holds still while somebody else speaks too, without a
detector of that. A small loudspeaker is pushed into its limits, so it filters two distortions of
what is played, too (a Hammerstein model); and the clocks of loudspeaker and microphone are not one,
so the filter goes with their drift (`clock_drift`). A person's voice it leaves as it is.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.clock_drift import ClockDrift

BLOCK_SAMPLES = 256
REACH_BLOCKS = 40
"""0.64 s at 16 kHz: the longest delay, and the room after it."""
KEEPS = np.float32(0.996)
"""How much the way is believed to stay the same from one block to the next. Less follows what
moves, more takes out more where nothing does."""
SMOOTHS = np.float32(0.4)
"""Of the power of what is left: by it, it tells a person from what it has not learnt yet."""
UNKNOWN = np.float32(0.1)
"""How unsure it is at first of each number of the filter, as a power of what that may be."""
LIMIT = np.float32(0.3)
"""From about here on, of full scale, a loudspeaker is taken to distort."""
JOINED_EVERY, ACROSS = 8, 16
"""In blocks: as it goes with the clocks, up to so many samples of a block of the filter move on to
the one beside it.
"""
_HALF, _NOTHING = np.float32(0.5), np.float32(1e-9)

Sound = NDArray[np.floating[Any]]
"""Mono, shape (n,), float32; full scale is 1."""
Spectra = NDArray[np.complexfloating[Any, Any]]
"""Complex64, shape (ways, blocks, bins): those of what is played, and of its distortions."""


class AdaptiveFilter:
    """Takes blocks of what was heard and what was played, and gives back what is left."""

    def __init__(self) -> None:
        bins = BLOCK_SAMPLES + 1
        self._last = distorted(np.zeros(BLOCK_SAMPLES, np.float32))
        shape = (len(self._last), REACH_BLOCKS, bins)
        self._played: Spectra = np.zeros(shape, np.complex64)
        self._way: Spectra = np.zeros(shape, np.complex64)
        self._doubt = np.full(shape, UNKNOWN)
        self._left = np.full(bins, np.float32(1e-6))
        self._drift = ClockDrift(BLOCK_SAMPLES)
        self._blocks = 0

    @property
    def drift_ppm(self) -> float:
        """By how much the loudspeaker's clock is found to run faster than the microphone's."""
        return self._drift.ppm

    def push(self, heard: Sound, played: Sound) -> Sound:
        """`heard` without what comes of `played`; whole blocks, each of both as long."""
        return np.concatenate(
            [
                self._block(heard[at : at + BLOCK_SAMPLES], played[at : at + BLOCK_SAMPLES])
                for at in range(0, heard.size, BLOCK_SAMPLES)
            ]
        )

    def _block(self, heard: Sound, played: Sound) -> Sound:
        self._way *= self._drift.turns()
        self._blocks += 1
        if self._blocks % JOINED_EVERY == 0:
            self._join()
        ways = distorted(played)
        self._played = np.roll(self._played, 1, axis=1)
        self._played[:, 0] = np.fft.rfft(np.concatenate([self._last, ways], axis=1))
        self._last = ways
        echo = np.fft.irfft((self._played * self._way).sum(axis=(0, 1)))[BLOCK_SAMPLES:]
        left = heard - echo
        change = self._learn(np.fft.rfft(np.concatenate([np.zeros_like(left), left])))
        self._drift.follow(self._way[0], change[0], _power(heard), _power(left))
        self._way += change
        return np.asarray(left)

    def _learn(self, left: Spectra) -> Spectra:
        """By what the way is to change, after what was left of a block."""
        power = _squared(self._played)
        self._left = SMOOTHS * self._left + (1 - SMOOTHS) * _squared(left)
        expected = _HALF * (power * self._doubt).sum(axis=(0, 1)) + self._left + _NOTHING
        step = self._doubt / expected
        change = np.fft.irfft(step * np.conj(self._played) * left)
        change[..., BLOCK_SAMPLES:] = 0.0  # a filter longer than a block would wrap around
        known = np.maximum(1 - _HALF * step * power, 0.0)
        self._doubt *= KEEPS**2 * known
        self._doubt += (1 - KEEPS**2) * _squared(self._way)
        return np.asarray(np.fft.rfft(change), np.complex64)

    def _join(self) -> None:
        """Give what has moved out of a block of the filter to the one before or after it."""
        way = np.fft.irfft(self._way)
        way[:, 1:, :ACROSS] += way[:, :-1, BLOCK_SAMPLES : BLOCK_SAMPLES + ACROSS]
        way[:, :-1, BLOCK_SAMPLES - ACROSS : BLOCK_SAMPLES] += way[:, 1:, -ACROSS:]
        way[..., BLOCK_SAMPLES:] = 0.0
        self._way = np.fft.rfft(way)


def distorted(played: Sound) -> Sound:
    """As it is, at its limits, and by how much those differ on both sides: shape (3, n)."""
    limited = np.tanh(played / LIMIT)
    return np.stack([played, LIMIT * limited, _HALF * LIMIT * limited**2])


def _squared(spectra: Spectra) -> NDArray[np.floating[Any]]:
    return np.asarray(spectra.real**2 + spectra.imag**2)


def _power(sound: Sound) -> float:
    return float(np.mean(sound**2))
