"""A reader of WAV files of any rate, width and number of channels."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from edgevox.voice.audio import Samples

if TYPE_CHECKING:
    import av
import wave
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import regular
from edgevox.voice.audio import RATE_HZ


class Resampler:
    """Turns a stream of mono samples at one rate into another. Equal rates cost nothing."""

    def __init__(self, from_hz: int, to_hz: int) -> None:
        self._from_hz = from_hz
        self._equal = from_hz == to_hz
        import av  # FFmpeg: nothing that only types needs to wait for it

        self._frame = av.AudioFrame.from_ndarray
        self._engine = av.AudioResampler(format="s16", layout="mono", rate=to_hz)

    def push(self, samples: Samples) -> Samples:
        """Return the samples that are ready; a few milliseconds stay inside until `flush`."""
        if self._equal or not samples.size:
            return samples
        frame = self._frame(
            np.ascontiguousarray(samples[np.newaxis, :]), format="s16", layout="mono"
        )
        frame.sample_rate = self._from_hz
        return _joined(self._engine.resample(frame))

    def flush(self) -> Samples:
        """Return the samples that were still inside; push nothing afterwards."""
        return np.empty(0, np.int16) if self._equal else _joined(self._engine.resample(None))


def resampled(samples: Samples, from_hz: int, to_hz: int) -> Samples:
    """All of it at once."""
    stream = Resampler(from_hz, to_hz)
    return np.concatenate([stream.push(samples), stream.flush()])


def _joined(frames: "Iterable[av.AudioFrame]") -> Samples:
    pieces = [frame.to_ndarray()[0] for frame in frames]
    return np.concatenate(pieces) if pieces else np.empty(0, np.int16)


LEAST_HZ, MOST_HZ = 1000, 768_000
"""Bounds of the rate in a header: the reader allocates memory by it."""
HEADER_BYTES = 44
"""Before the samples, in what most programs write."""
WIDTHS = (1, 2, 3, 4)
"""Bytes of a sample."""


def check_wav(path: Path, field: str = "audio_in") -> None:
    """Raise `InvalidValue` for what cannot be read as a WAV file."""
    with _opened(path, field):
        pass


def stream_wav(path: Path) -> Iterator[Samples]:
    """Yield a file's samples, mono at `RATE_HZ`, a second at a time: hours of sound take no memory.

    Raises `InvalidValue` for a file that is no WAV file of PCM.
    """
    with _opened(path, "audio_in") as file:
        channels, width, from_hz = file.getnchannels(), file.getsampwidth(), file.getframerate()
        resampler = Resampler(from_hz, RATE_HZ)
        while data := file.readframes(from_hz):
            whole = len(data) // (channels * width) * channels * width
            yield resampler.push(pcm_to_mono(data[:whole], width, channels))
        yield resampler.flush()


@contextmanager
def _opened(path: Path, field: str) -> Iterator[wave.Wave_read]:
    with ExitStack() as stack:
        try:
            data = stack.enter_context(open(path, "rb", opener=regular))
            file = stack.enter_context(wave.open(data))
        except (wave.Error, EOFError, OSError, RuntimeError) as error:  # it seeks beyond a chunk
            raise InvalidValue(field, str(path), f"a WAV file of PCM ({error})") from None
        if not LEAST_HZ <= (rate_hz := file.getframerate()) <= MOST_HZ:
            expected = f"a WAV file of {LEAST_HZ} to {MOST_HZ} samples a second, not {rate_hz}"
            raise InvalidValue(field, str(path), expected)
        if (width := file.getsampwidth()) not in WIDTHS:
            raise InvalidValue(field, str(path), f"a WAV file of 8 to 32 bits, not {8 * width}")
        yield file


def pcm_to_mono(data: bytes, width: int, channels: int) -> Samples:
    """PCM of whole frames, of 1 (unsigned) to 4 bytes a sample, as mono samples of 16 bits."""
    mono = _scaled(data, width).reshape(-1, channels).mean(axis=1)
    samples: Samples = np.clip(mono, -32768, 32767).astype(np.int16)
    return samples


def _scaled(data: bytes, width: int) -> NDArray[np.floating[Any]]:
    """PCM of 1 (unsigned) to 4 bytes a sample, in the range of 16 bits."""
    if width == 1:
        return (np.frombuffer(data, np.uint8).astype(np.float64) - 128.0) * 256.0
    if width == 3:
        padded = np.zeros((len(data) // 3, 4), np.uint8)
        padded[:, 1:] = np.frombuffer(data, np.uint8).reshape(-1, 3)
        data, width = padded.tobytes(), 4
    wide: NDArray[np.floating[Any]] = np.frombuffer(data, f"<i{width}").astype(np.float64)
    return wide / 2.0 ** (8 * (width - 2))
