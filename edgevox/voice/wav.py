"""A reader of WAV files of any rate, width and number of channels, and of those from a network.

The length of a file that comes over a network is not known, and its end may be missing.
"""

import struct
import wave
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import regular
from edgevox.core.servers.errors import Unusable
from edgevox.voice.audio import RATE_HZ, Samples

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


LEAST_HZ, MOST_HZ = 8000, 192_000
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


MOST_CHANNELS = 8
_PCM, _EXTENSIBLE = 1, 0xFFFE
_LONGEST_HEADER = 1 << 16
_UNKNOWN = (0, 0x7FFFFFFF, 0x7FFFF000, 0xFFFFFFFF)
"""Lengths that writers of streams give, since they do not know it yet."""


def check_form(rate_hz: int, width: int, channels: int) -> None:
    """Raise `Unusable` for a form of sound that cannot be played."""
    if not (LEAST_HZ <= rate_hz <= MOST_HZ and width in WIDTHS and 1 <= channels <= MOST_CHANNELS):
        raise Unusable(
            f"sound of {rate_hz} Hz, {8 * width} bits, {channels} channels; expected PCM of"
            f" {LEAST_HZ} to {MOST_HZ} Hz, 8 to 32 bits, 1 to {MOST_CHANNELS} channels"
        )


class PcmStream:
    """Turns bytes of any number into mono samples; what is no whole frame waits for the rest."""

    def __init__(self, rate_hz: int, width: int, channels: int) -> None:
        check_form(rate_hz, width, channels)
        self.rate_hz = rate_hz
        self._width, self._channels = width, channels
        self._rest = b""

    def push(self, data: bytes) -> Samples:
        data = self._rest + data
        frame = self._width * self._channels
        whole = len(data) // frame * frame
        self._rest = data[whole:]
        return pcm_to_mono(data[:whole], self._width, self._channels)


class WavStream:
    """Reads a WAV file piece by piece. Raises `Unusable` for what is no WAV file of PCM."""

    def __init__(self) -> None:
        self._head = b""
        self._pcm: PcmStream | None = None
        self._left: int | None = None

    @property
    def rate_hz(self) -> int:
        """The rate in hertz; 0 until it is known."""
        return self._pcm.rate_hz if self._pcm else 0

    def push(self, data: bytes) -> Samples:
        """The samples that are whole now."""
        if self._pcm is None:
            data = self._begin(data)
        if self._pcm is None:
            return np.empty(0, np.int16)
        if self._left is not None:
            data = data[: self._left]
            self._left -= len(data)
        return self._pcm.push(data)

    def _begin(self, data: bytes) -> bytes:
        """Read the header as far as it is here; what follows it."""
        self._head += data
        head = self._head
        if head[:4] != b"RIFF"[: len(head[:4])] or head[8:12] != b"WAVE"[: len(head[8:12])]:
            raise Unusable(f"not a WAV file: {head[:16]!r}")
        at, form = 12, b""
        while len(head) >= at + 8:
            name, size = head[at : at + 4], struct.unpack_from("<I", head, at + 4)[0]
            at += 8
            if name == b"data":
                self._pcm = _stream_of(form)
                self._left = None if size in _UNKNOWN else size
                self._head = b""
                return head[at:]
            if name == b"fmt ":
                form = head[at : at + size]
            at += size + size % 2
        if len(head) > _LONGEST_HEADER:
            raise Unusable("not a WAV file: a header without end")
        return b""


def _stream_of(form: bytes) -> PcmStream:
    if len(form) < 16:
        raise Unusable("a WAV file without a format")
    kind, channels, rate_hz, _, _, bits = struct.unpack_from("<HHIIHH", form)
    if kind == _EXTENSIBLE and len(form) >= 26:
        kind = struct.unpack_from("<H", form, 24)[0]
    if kind != _PCM:
        raise Unusable(f"a WAV file of format {kind}, expected PCM ({_PCM})")
    return PcmStream(rate_hz, bits // 8, channels)
