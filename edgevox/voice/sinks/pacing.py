"""What every sink needs: to wait against a clock, to change rates, to know how loud it is."""

from collections import deque
from collections.abc import Callable

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk, Samples
from edgevox.voice.level import rms
from edgevox.voice.resample import Resampler

AHEAD_S = 0.1
"""How much sound a sink takes before it blocks."""

NOTHING_S = 1e-6
"""Less than this is not worth waiting for, and might not move a clock at all."""

Wait = Callable[[CancelToken, float], bool]
"""Sleep for so many seconds or until cancelled; True if cancelled."""


def real_wait(token: CancelToken, seconds: float) -> bool:
    """Sleep in real time."""
    return token.wait(seconds)


class RateChanger:
    """Chunks at any rate, one after another, as sound at one rate."""

    def __init__(self, rate_hz: int) -> None:
        self._to_hz = rate_hz
        self._from_hz = rate_hz
        self._engine: Resampler | None = None

    def push(self, chunk: Chunk) -> Samples:
        """What can be played now; the rest comes with the next chunk or with `flush`."""
        before = np.empty(0, np.int16)
        if self._engine is None or chunk.rate_hz != self._from_hz:
            before = self.flush()
            self._from_hz = chunk.rate_hz
            self._engine = Resampler(chunk.rate_hz, self._to_hz)
        return np.concatenate([before, self._engine.push(chunk.samples)])

    def flush(self) -> Samples:
        """What was still inside; the next chunk begins anew."""
        engine, self._engine = self._engine, None
        return engine.flush() if engine else np.empty(0, np.int16)


class Loudness:
    """How loud a sink is at a moment, by the sound that it was given for it."""

    def __init__(self) -> None:
        self._blocks: deque[tuple[float, float]] = deque(maxlen=1024)

    def add(self, end_s: float, samples: Samples) -> None:
        """Sound that is heard until `end_s`, right after what was added before."""
        self._blocks.append((end_s, rms(samples)))

    def at(self, now_s: float) -> float:
        """Root mean square, 0 to 1."""
        while self._blocks and self._blocks[0][0] <= now_s:
            self._blocks.popleft()
        return self._blocks[0][1] if self._blocks else 0.0

    def clear(self) -> None:
        """Nothing more is heard."""
        self._blocks.clear()
