"""Reading WAV files of any rate, width and number of channels."""

import wave
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import regular
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.resample import Resampler

LEAST_HZ, MOST_HZ = 1000, 768_000
"""What a header may say of the rate: memory is taken by it."""
HEADER_BYTES = 44
"""Before the samples, in what most programs write."""
_WIDTHS = (1, 2, 3, 4)


def check_wav(path: Path, field: str = "audio_in") -> None:
    """Raise `InvalidValue` for what cannot be read as a WAV file."""
    with _opened(path, field):
        pass


def stream_wav(path: Path) -> Iterator[Samples]:
    """A file, mono at `RATE_HZ`, a second at a time: one of hours takes no memory.

    Raises `InvalidValue` for what is not a WAV file of PCM.
    """
    with _opened(path, "audio_in") as file:
        channels, width, from_hz = file.getnchannels(), file.getsampwidth(), file.getframerate()
        resampler = Resampler(from_hz, RATE_HZ)
        while data := file.readframes(from_hz):
            whole = len(data) // (channels * width) * channels * width
            mono = _scaled(data[:whole], width).reshape(-1, channels).mean(axis=1)
            yield resampler.push(np.clip(mono, -32768, 32767).astype(np.int16))
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
        if (width := file.getsampwidth()) not in _WIDTHS:
            raise InvalidValue(field, str(path), f"a WAV file of 8 to 32 bits, not {8 * width}")
        yield file


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
