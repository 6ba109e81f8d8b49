"""By how much one clock runs faster than another, found in how a filter between both changes.

A filter that follows a drifting clock moves in time: each of its frequencies turns in phase, the
faster the higher it is. What of each change is such a turn tells the drift (a phase-locked loop).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_PPM = 300.0
"""Ordinary quartzes differ by less."""
AT_ONCE_PPM = 100.0
"""So much at most is believed of what one look says: at first the filter changes by more than
drift."""
FOLLOWS, LOOKS = 0.07, 30
"""How much of what the last looks say is believed at each, and over about how many is meant."""
_NOTHING = 1e-9


class ClockDrift:
    """Follows the drift from block to block.

    `ppm` is by how much what plays runs faster than what hears, 0 at first.
    """

    def __init__(self, block_samples: int) -> None:
        self._block = block_samples
        self._angles = (np.pi / block_samples * np.arange(block_samples + 1)).astype(np.float32)
        self._turned = self._heard = self._left = 0.0
        self._weight = _NOTHING
        self.ppm = 0.0

    def turns(self) -> NDArray[np.complex64]:
        """By what each frequency of the filter is to turn from one block to the next."""
        samples = np.float32(self.ppm * 1e-6 * self._block)
        return np.asarray(np.exp(1j * samples * self._angles), np.complex64)

    def follow(
        self,
        way: NDArray[np.complexfloating[Any, Any]],
        change: NDArray[np.complexfloating[Any, Any]],
        heard: float,
        left: float,
    ) -> None:
        """Look at how the filter `way` (blocks, bins) is about to change, and at the powers of what
        was heard and of what it left: who takes out nothing has nothing to say.
        """
        turned = self._angles * (way.real * change.imag - way.imag * change.real)
        weight = self._angles**2 * (way.real**2 + way.imag**2)
        self._turned += (float(turned.sum()) - self._turned) / LOOKS
        self._weight += (float(weight.sum()) - self._weight) / LOOKS
        self._heard += (heard - self._heard) / LOOKS
        self._left += (left - self._left) / LOOKS
        samples = self._turned / (self._weight + _NOTHING)
        found = np.clip(1e6 * samples / self._block, -AT_ONCE_PPM, AT_ONCE_PPM)
        sure = max(0.0, 1 - self._left / (self._heard + _NOTHING))
        self.ppm = float(np.clip(self.ppm + FOLLOWS * sure * found, -MOST_PPM, MOST_PPM))
