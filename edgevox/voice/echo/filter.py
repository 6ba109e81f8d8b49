"""An adaptive echo canceller and the drift between two audio clocks.

`AdaptiveFilter` is a partitioned-block frequency-domain Kalman filter. It models the path from
loudspeaker to microphone as a linear filter and keeps an uncertainty for every frequency. So it
learns fast at first and while only the loudspeaker is heard, and holds still while a person speaks
too, without a detector for that double talk. A small loudspeaker is driven into its limits, so two
distortions of the played sound are filtered as well (a Hammerstein model). A person's voice passes
unchanged.

`ClockDrift` estimates by how much the loudspeaker's clock runs faster than the microphone's. A
filter that follows a drifting clock moves in time: each of its frequencies turns in phase, in
proportion to the frequency. The part of each change that is such a turn gives the drift (a
phase-locked loop).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_PPM = 300.0
"""Ordinary quartzes differ by less."""
AT_ONCE_PPM = 100.0
"""Most drift that one look may report: at first, the filter changes for more reasons than drift."""
FOLLOWS, LOOKS = 0.07, 30
"""The share of the latest looks' result that each look adds, and the number of looks in that
mean."""
_NO_WEIGHT = 1e-9


class ClockDrift:
    """Follows the drift from block to block.

    `ppm` is by how much the loudspeaker's clock runs faster than the microphone's, 0 at first.
    """

    def __init__(self, block_samples: int) -> None:
        self._block = block_samples
        self._angles = (np.pi / block_samples * np.arange(block_samples + 1)).astype(np.float32)
        self._turned = self._heard = self._left = 0.0
        self._weight = _NO_WEIGHT
        self.ppm = 0.0

    def turns(self) -> NDArray[np.complex64]:
        """Return the phase factor of each frequency of the filter from one block to the next."""
        samples = np.float32(self.ppm * 1e-6 * self._block)
        return np.asarray(np.exp(1j * samples * self._angles), np.complex64)

    def follow(
        self,
        way: NDArray[np.complexfloating[Any, Any]],
        change: NDArray[np.complexfloating[Any, Any]],
        heard: float,
        left: float,
    ) -> None:
        """Update the drift from the change of the filter.

        Args:
            way: The filter, shape (blocks, bins).
            change: The filter's change in this block, of the same shape.
            heard: The power of the microphone's block.
            left: The power of what the filter left of it. A filter that removes nothing changes
                nothing here.
        """
        turned = self._angles * (way.real * change.imag - way.imag * change.real)
        weight = self._angles**2 * (way.real**2 + way.imag**2)
        self._turned += (float(turned.sum()) - self._turned) / LOOKS
        self._weight += (float(weight.sum()) - self._weight) / LOOKS
        self._heard += (heard - self._heard) / LOOKS
        self._left += (left - self._left) / LOOKS
        samples = self._turned / (self._weight + _NO_WEIGHT)
        found = np.clip(1e6 * samples / self._block, -AT_ONCE_PPM, AT_ONCE_PPM)
        sure = max(0.0, 1 - self._left / (self._heard + _NO_WEIGHT))
        self.ppm = float(np.clip(self.ppm + FOLLOWS * sure * found, -MOST_PPM, MOST_PPM))


BLOCK_SAMPLES = 256
REACH_BLOCKS = 40
"""0.64 s at 16 kHz: the longest delay, and the room after it."""
KEEPS = np.float32(0.996)
"""The share of the path that is believed to stay from one block to the next. A lower value
follows movement faster; a higher one removes more echo where nothing moves."""
SMOOTHS = np.float32(0.4)
"""Weight of the past in the mean power of the residual, which tells a person's voice from echo
that is not learnt yet."""
UNKNOWN = np.float32(0.1)
"""Uncertainty of each coefficient at the start, as the power that it may have."""
LIMIT = np.float32(0.3)
"""The level, of full scale, from about which a loudspeaker is taken to distort."""
JOINED_EVERY, ACROSS = 8, 16
"""Blocks between two joins, and the samples that move across a block's edge then: the filter
follows the clocks, so up to this many samples of a block move on to its neighbour."""
_HALF, _NOTHING = np.float32(0.5), np.float32(1e-9)

Sound = NDArray[np.floating[Any]]
"""Mono, shape (n,), float32; full scale is 1."""
Spectra = NDArray[np.complexfloating[Any, Any]]
"""Complex64, shape (ways, blocks, bins), of the played sound and its distortions."""


class AdaptiveFilter:
    """Takes blocks of heard and played sound, and returns the heard sound without the echo."""

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
        """The estimated drift.

        By how much the loudspeaker's clock runs faster than the microphone's.
        """
        return self._drift.ppm

    def push(self, heard: Sound, played: Sound) -> Sound:
        """Return `heard` without the echo of `played`; whole blocks, both of the same length."""
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
        """Return the filter's change, from the spectrum that was left of a block."""
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
    """Return the sound, its limited form, and its asymmetric distortion: shape (3, n)."""
    limited = np.tanh(played / LIMIT)
    return np.stack([played, LIMIT * limited, _HALF * LIMIT * limited**2])


def _squared(spectra: Spectra) -> NDArray[np.floating[Any]]:
    return np.asarray(spectra.real**2 + spectra.imag**2)


def _power(sound: Sound) -> float:
    return float(np.mean(sound**2))
