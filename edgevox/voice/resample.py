"""Another sample rate, by FFmpeg's resampler, as sound streams in."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from edgevox.voice.audio import Samples

if TYPE_CHECKING:
    import av


class Resampler:
    """Turns a stream of mono samples at one rate into another. Equal rates cost nothing."""

    def __init__(self, from_hz: int, to_hz: int) -> None:
        self._from_hz = from_hz
        self._equal = from_hz == to_hz
        import av  # FFmpeg: nothing that only types needs to wait for it

        self._frame = av.AudioFrame.from_ndarray
        self._engine = av.AudioResampler(format="s16", layout="mono", rate=to_hz)

    def push(self, samples: Samples) -> Samples:
        """What is ready after these samples; a few milliseconds stay inside until `flush`."""
        if self._equal or not samples.size:
            return samples
        frame = self._frame(
            np.ascontiguousarray(samples[np.newaxis, :]), format="s16", layout="mono"
        )
        frame.sample_rate = self._from_hz
        return _joined(self._engine.resample(frame))

    def flush(self) -> Samples:
        """What was still inside; nothing may be pushed afterwards."""
        return np.empty(0, np.int16) if self._equal else _joined(self._engine.resample(None))


def resampled(samples: Samples, from_hz: int, to_hz: int) -> Samples:
    """All of it at once."""
    stream = Resampler(from_hz, to_hz)
    return np.concatenate([stream.push(samples), stream.flush()])


def _joined(frames: "Iterable[av.AudioFrame]") -> Samples:
    pieces = [frame.to_ndarray()[0] for frame in frames]
    return np.concatenate(pieces) if pieces else np.empty(0, np.int16)
