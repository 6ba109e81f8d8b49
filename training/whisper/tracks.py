"""What is said, faster and slower, as it is put together before anybody hears it."""

import numpy as np
from numpy.typing import NDArray

from edgevox.voice.audio import RATE_HZ, Samples
from training.acoustics.mixing import voiced_power

Wave = NDArray[np.float32]

FASTER = (0.85, 1.18)


def varied(samples: Samples, rng: np.random.Generator) -> Wave:
    """Faster or slower, as a whole: pitch goes with it; and at a loudness of 1."""
    step = rng.uniform(*FASTER)
    n = int(samples.size / step)
    changed = np.interp(np.arange(n) * step, np.arange(samples.size), samples)
    return (changed / np.sqrt(voiced_power(changed) + 1e-9)).astype(np.float32)


def silence(seconds: float) -> Wave:
    """So much of nothing."""
    return np.zeros(int(seconds * RATE_HZ), np.float32)


class Drawn:
    """Draws numbers from 0 on, each as often as its weight says."""

    def __init__(self, weights: NDArray[np.float64]) -> None:
        self._sums = np.cumsum(weights)

    def one(self, rng: np.random.Generator) -> int:
        return int(np.searchsorted(self._sums, rng.random() * self._sums[-1], side="right"))
