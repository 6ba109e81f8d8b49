"""The sink that the setting `audio_out` names, and the one that writes a WAV file."""

import struct
from contextlib import suppress
from pathlib import Path

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import regular
from edgevox.core.log import get_logger
from edgevox.voice.audio import AudioSink, Samples
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.sinks.card import SoundCardSink
from edgevox.voice.sinks.paced import PacedOutput, PacedSink, Silence
from edgevox.voice.wav import HEADER_BYTES

log = get_logger(__name__)

RATE_HZ = 24_000
"""No voice has a higher one."""
RETRY_S = 5.0
"""Seconds before a file system that failed is tried again."""
_MOST_BYTES = 0xFFFF_FFFF - HEADER_BYTES


class WavFile:
    """A WAV file that is valid after every write, even if the process is killed after it.

    The file starts at the clock's time of its opening; silence fills the gaps between sounds. While
    the file system fails, sound is dropped: that is reported once, in `fault` and in the log, and
    tried again every few seconds. Sound that was written before stays.
    """

    name = "file"
    rate_hz = RATE_HZ
    block_s = 0.02
    lead_s = 0.0

    def __init__(self, path: Path, clock: Clock | None = None, *, retry_s: float = RETRY_S) -> None:
        """Raises `InvalidValue` if the file cannot be written."""
        self._clock = clock or SystemClock()
        self._start_s = self._clock.now()
        self._path = path
        self._retry_s = retry_s
        self._retry_at_s = float("-inf")
        self._written = 0
        self.fault = ""
        try:
            self._file = open(path, "wb", buffering=0, opener=regular)  # noqa: SIM115 - until close
            self._write_all(_header(0))
        except OSError as error:
            expected = f"a WAV file that can be written ({error.strerror})"
            raise InvalidValue("audio_out", str(path), expected) from None

    def write(self, samples: Samples, start_s: float) -> None:
        """Write sound at its time. A gap before it is a hole in the file, read as silence."""
        position = max(self._written, round((start_s - self._start_s) * self.rate_hz))
        end = 2 * (position + len(samples))
        if end > _MOST_BYTES or not len(samples):
            return
        if self.fault and self._clock.now() < self._retry_at_s:
            return
        try:
            self._file.seek(HEADER_BYTES + 2 * position)
            self._write_all(samples.astype("<i2").tobytes())
            self._file.seek(0)
            self._write_all(_header(end))
        except OSError as error:
            self._fail(error)
            return
        self._written = position + len(samples)
        if self.fault:
            self.fault = ""
            log.warning("speech_file_written_again", path=str(self._path))

    def close(self) -> None:
        self._file.close()

    def _write_all(self, data: bytes) -> None:
        """Raises `OSError`; a disk that fills up takes a part first, without a word."""
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) or 0 :]

    def _fail(self, error: OSError) -> None:
        """The header still tells of what was written before; what came after it is cut off."""
        with suppress(OSError):
            self._file.truncate(HEADER_BYTES + 2 * self._written)
        self._retry_at_s = self._clock.now() + self._retry_s
        why = f"{self._path}: {error.strerror or error}"
        if not self.fault:
            log.error("speech_file_not_written", reason=why, retry_s=self._retry_s)
        self.fault = why


def _header(data_bytes: int) -> bytes:
    """Return the header of a WAV file: PCM, mono, 16 bit."""
    return struct.pack(
        "<4sI4s4sIHHIIHH4sI",
        *(b"RIFF", data_bytes + HEADER_BYTES - 8, b"WAVE"),
        *(b"fmt ", 16, 1, 1, RATE_HZ, 2 * RATE_HZ, 2, 16),
        *(b"data", data_bytes),
    )


ROS2 = "ros2"
NONE = "none"


def open_sink(
    spec: str,
    *,
    relay: PacedOutput | None = None,
    clock: Clock | None = None,
    played: PlayedSound | None = None,
) -> AudioSink:
    """The sink for `audio_out`.

    Empty is the default loudspeaker, ``none`` silence, ``ros2`` the relay that
    `edgevox.ros2.audio` connects to, a path a WAV file, anything else a loudspeaker's name. A
    path ends in ``.wav`` or has a slash. What can be heard of it in a room is told to `played`.
    Raises `InvalidValue`.
    """
    if spec == NONE:
        return PacedSink(Silence(), clock=clock)
    if spec == ROS2:
        if relay is None:
            raise InvalidValue("audio_out", spec, "ros2 only together with --ros2")
        return PacedSink(relay, clock=clock, played=played)
    path = Path(spec).expanduser()
    if spec and ("/" in spec or path.suffix.lower() == ".wav"):
        return _file(path, clock)
    return SoundCardSink(spec, clock=clock, played=played)


def _file(path: Path, clock: Clock | None) -> AudioSink:
    if path.is_dir() or path.suffix.lower() != ".wav":
        raise InvalidValue("audio_out", str(path), "a file whose name ends in .wav")
    return PacedSink(WavFile(path, clock), clock=clock)
