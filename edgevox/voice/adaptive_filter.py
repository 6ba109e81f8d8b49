"""What of a sound is the answer of a room to another sound, learnt as both go on.

A partitioned-block frequency-domain Kalman filter: it models the way from loudspeaker to microphone
as a linear filter, and knows for every frequency how sure it is of it. So it learns fast at first
and where only the loudspeaker is heard, and holds still while somebody else speaks too, without a
detector of that. What it cannot take out is what distorts; a person's voice it leaves as it is.
"""

import numpy as np
from numpy.typing import NDArray

BLOCK_SAMPLES = 256
REACH_BLOCKS = 40
"""0.64 s at 16 kHz: the longest delay, and the room after it."""
KEEPS = 0.996
"""How much the way is believed to stay the same from one block to the next. Less follows clocks
that drift, more takes out more where nothing does."""
SMOOTHS = 0.6
"""Of the power of what is left: by it, it tells a person from what it has not learnt yet."""
_NOTHING = 1e-9

Sound = NDArray[np.float64]
"""Mono, shape (n,); full scale is 1."""
Spectra = NDArray[np.complex128]


class AdaptiveFilter:
    """Takes blocks of what was heard and what was played, and gives back what is left."""

    def __init__(self) -> None:
        bins = BLOCK_SAMPLES + 1
        self._played: Spectra = np.zeros((REACH_BLOCKS, bins), np.complex128)
        self._way: Spectra = np.zeros((REACH_BLOCKS, bins), np.complex128)
        self._doubt = np.ones((REACH_BLOCKS, bins))
        self._left = np.full(bins, 1e-6)
        self._last = np.zeros(BLOCK_SAMPLES)

    def push(self, heard: Sound, played: Sound) -> Sound:
        """`heard` without what comes of `played`; whole blocks, each of both as long."""
        return np.concatenate(
            [
                self._block(heard[at : at + BLOCK_SAMPLES], played[at : at + BLOCK_SAMPLES])
                for at in range(0, heard.size, BLOCK_SAMPLES)
            ]
        )

    def _block(self, heard: Sound, played: Sound) -> Sound:
        self._played = np.roll(self._played, 1, axis=0)
        self._played[0] = np.fft.rfft(np.concatenate([self._last, played]))
        self._last = played
        echo = np.fft.irfft((self._played * self._way).sum(axis=0))[BLOCK_SAMPLES:]
        left = heard - echo
        self._learn(np.fft.rfft(np.concatenate([np.zeros(BLOCK_SAMPLES), left])))
        return left

    def _learn(self, left: Spectra) -> None:
        power = self._played.real**2 + self._played.imag**2
        self._left = SMOOTHS * self._left + (1 - SMOOTHS) * np.abs(left) ** 2
        expected = 0.5 * (power * self._doubt).sum(axis=0) + self._left + _NOTHING
        step = self._doubt / expected
        change = np.fft.irfft(step * np.conj(self._played) * left, axis=1)
        change[:, BLOCK_SAMPLES:] = 0.0  # a filter longer than a block would wrap around
        self._way += np.fft.rfft(change, axis=1)
        known = np.maximum(1 - 0.5 * step * power, 0.0)
        self._doubt *= KEEPS**2 * known
        self._doubt += (1 - KEEPS**2) * np.abs(self._way) ** 2
