"""Sound in pieces of any size, cut into frames that know when they were heard."""

from collections.abc import Iterator

import numpy as np

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Frame, Samples


class Framer:
    """Collects mono samples at 16 kHz and gives them back in whole frames."""

    def __init__(self) -> None:
        self._left = np.empty(0, np.int16)

    def push(self, samples: Samples, end_s: float) -> Iterator[Frame]:
        """The frames that are whole now; `end_s` is the clock's time of the last sample given."""
        held = np.concatenate([self._left, samples])
        whole = held.size // FRAME_SAMPLES * FRAME_SAMPLES
        self._left = held[whole:]
        for start in range(0, whole, FRAME_SAMPLES):
            end = start + FRAME_SAMPLES
            yield Frame(held[start:end], end_s - (held.size - end) / RATE_HZ)

    def reset(self) -> None:
        """Forget what is not a whole frame yet: the next samples do not follow on it."""
        self._left = np.empty(0, np.int16)
