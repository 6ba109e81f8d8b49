"""How loud sound is."""

import numpy as np

from edgevox.voice.audio import Samples

FULL_SCALE = 32768.0


def rms(samples: Samples) -> float:
    """Root mean square, 0 (silent, or no samples) to 1 (a full-scale square wave)."""
    if not samples.size:
        return 0.0
    wide = samples.astype(np.float64)
    return float(np.sqrt(np.dot(wide, wide) / wide.size) / FULL_SCALE)
