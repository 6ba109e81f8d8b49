"""The source that a setting names: a microphone, WAV files as if somebody spoke them, or none.

A missing or unplugged microphone is reported and tried again.
"""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.log import ChangeDetector, get_logger
from edgevox.voice import devices
from edgevox.voice.audio import (
    FRAME_S,
    FRAME_SAMPLES,
    RATE_HZ,
    AudioSource,
    EndOfSound,
    Frame,
    Samples,
)
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.wav import Resampler, check_wav, stream_wav

log = get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Capture:
    """A running stream of PortAudio."""

    name: str
    stream: Any

    @property
    def active(self) -> bool:
        return devices.is_active(self.stream)


@contextmanager
def open_microphone(name: str, hear: Callable[[Samples], None]) -> Iterator[Capture]:
    """Capture from the device of this name, as `Opener` says it."""
    with devices.portaudio_errors():
        devices.look_again()
    with devices.in_use(), devices.portaudio_errors():
        import sounddevice

        device = devices.find(name, "input")
        rate_hz, channels = _format(sounddevice, device)
        resampler = Resampler(rate_hz, RATE_HZ)

        def callback(block: Any, _frames: int, _time: Any, _status: Any) -> None:
            hear(resampler.push(block[:, 0].copy()))

        try:
            with sounddevice.InputStream(
                device=device.index,
                samplerate=rate_hz,
                channels=channels,
                dtype="int16",
                blocksize=FRAME_SAMPLES * rate_hz // RATE_HZ,
                callback=callback,
            ) as stream:
                try:
                    yield Capture(device.name, stream)
                finally:
                    stream.abort()  # to stop it would wait for a device that may be gone
        except sounddevice.PortAudioError as error:
            raise DeviceMissing(f"{device.name} cannot be opened: {error}") from None


def _format(sounddevice: Any, device: devices.Device) -> tuple[int, int]:
    """Rate in hertz and channels: 16 kHz mono, or else what the device does by itself.

    Of several channels the first is heard: on arrays of microphones it is the processed one.
    """
    try:
        sounddevice.check_input_settings(device.index, 1, "int16", samplerate=RATE_HZ)
    except (sounddevice.PortAudioError, ValueError):
        return device.rate_hz, device.channels
    return RATE_HZ, 1


SILENT_S = 2.0
"""A stream that gives nothing for this long is lost: PortAudio does not always say so."""


class CaptureStream(Protocol):
    """A running capture."""

    @property
    def name(self) -> str: ...

    @property
    def active(self) -> bool:
        """False once PortAudio itself has given it up."""


Opener = Callable[[str, Callable[[Samples], None]], AbstractContextManager[CaptureStream]]
"""Opens the device of a name and calls back with mono sound at 16 kHz, until the context ends.

Raises `DeviceMissing`.
"""


class SoundCard:
    """Captures from the device whose name is, or contains, `device`; from the default if empty."""

    def __init__(
        self,
        device: str = "",
        *,
        opener: Opener = open_microphone,
        clock: Clock | None = None,
        retry_s: float = RETRY_S,
        silent_s: float = SILENT_S,
    ) -> None:
        self.name = device or "the default microphone"
        self._device = device
        self._open = opener
        self._clock = clock or SystemClock()
        self._retry_s = retry_s
        self._silent_s = silent_s
        self._queue = Pushed(self.name, self._clock)
        self._heard_s = 0.0
        self._is_news = ChangeDetector()
        self.fault = ""
        """The reason why nothing is heard now; empty while the device is open."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._keep_open, name="edgevox-microphone")

    @property
    def dropped(self) -> int:
        """Frames that were not read in time."""
        return self._queue.dropped

    def start(self) -> None:
        self._thread.start()

    def read(self, timeout_s: float) -> Frame | None:
        return self._queue.read(timeout_s)

    def close(self) -> None:
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()
        self._queue.close()

    def _keep_open(self) -> None:
        while not self._closing.is_set():
            try:
                with self._open(self._device, self._hear) as stream:
                    self.fault = ""
                    if self._is_news("open", stream.name):
                        log.info("microphone_open", device=stream.name)
                    self._watch(stream)
            except DeviceMissing as error:
                self.fault = str(error)
                if self._is_news(self.fault):
                    log.warning("microphone_lost", reason=self.fault, retry_s=self._retry_s)
            self._queue.interrupted()
            self._closing.wait(self._retry_s)

    def _watch(self, stream: CaptureStream) -> None:
        """Return when closing; raise `DeviceMissing` when nothing comes any more."""
        self._heard_s = self._clock.now()
        while not self._closing.wait(self._silent_s / 4):
            if not stream.active or self._clock.now() - self._heard_s > self._silent_s:
                raise DeviceMissing(f"{stream.name} gives no sound any more")

    def _hear(self, samples: Samples) -> None:
        """Called on PortAudio's thread."""
        self._heard_s = self._clock.now()
        self._queue.push(samples)


GAP_S = 1.0
"""Silence after each file: what is spoken in it ends there."""


class WavFiles:
    """Plays files one after the other into the listener.

    If `paced`, a frame is ready when the clock reaches its end; else at once. A frame's time is
    always that of its samples, counted from `start`. At the end `read` raises `EndOfSound`.
    """

    def __init__(
        self,
        paths: Sequence[Path],
        *,
        paced: bool = True,
        gap_s: float = GAP_S,
        clock: Clock | None = None,
    ) -> None:
        self.name = ", ".join(path.name for path in paths)
        self._frames = _frames(paths, gap_s)
        self._paced = paced
        self._clock = clock or SystemClock()
        self._closed = threading.Event()
        self._started_s = 0.0
        self._read = 0
        self._next: Samples | None = None

    def start(self) -> None:
        """The first sample sounds now."""
        self._started_s = self._clock.now()

    def read(self, timeout_s: float) -> Frame | None:
        if self._next is None and (self._closed.is_set() or not self._advance()):
            raise EndOfSound(f"{self.name}: all of it was heard")
        end_s = self._started_s + (self._read + 1) * FRAME_S
        if self._paced and not self._reached(end_s, timeout_s):
            return None
        samples, self._next = self._next, None
        self._read += 1
        return None if samples is None else Frame(samples, end_s)

    def close(self) -> None:
        self._closed.set()

    def _advance(self) -> bool:
        self._next = next(self._frames, None)
        return self._next is not None

    def _reached(self, when_s: float, timeout_s: float) -> bool:
        left_s = when_s - self._clock.now()
        if left_s > 0:
            self._closed.wait(min(left_s, timeout_s))
        return when_s <= self._clock.now()


def wav_files(place: Path) -> list[Path]:
    """The file itself, or the WAV files of a folder in the order of their names."""
    if place.is_dir():
        return sorted(p for p in place.iterdir() if p.suffix.lower() == ".wav" and p.is_file())
    return [place]


def _frames(paths: Sequence[Path], gap_s: float) -> Iterator[Samples]:
    silence = np.zeros(int(gap_s * RATE_HZ) // FRAME_SAMPLES * FRAME_SAMPLES, np.int16)
    for path in paths:
        held = np.empty(0, np.int16)
        for block in stream_wav(path):
            held = np.concatenate([held, block])
            whole = held.size // FRAME_SAMPLES * FRAME_SAMPLES
            yield from held[:whole].reshape(-1, FRAME_SAMPLES)
            held = held[whole:]
        rest = np.zeros(-held.size % FRAME_SAMPLES, np.int16)
        yield from np.concatenate([held, rest, silence]).reshape(-1, FRAME_SAMPLES)


class Nothing:
    """Never hears anything; reading only waits."""

    name = "none"

    def __init__(self) -> None:
        self._closed = threading.Event()

    def start(self) -> None: ...

    def read(self, timeout_s: float) -> Frame | None:
        self._closed.wait(timeout_s)
        return None

    def close(self) -> None:
        self._closed.set()


ROS2 = "ros2"
NONE = "none"


def open_source(spec: str, *, paced: bool = True, clock: Clock | None = None) -> AudioSource:
    """The source that `audio_in` names; it captures nothing before its `start`.

    Empty is the default microphone, ``ros2`` a `Pushed` that `edgevox.ros2.audio` fills,
    ``none`` no microphone, a path a WAV file or a folder of them, anything else a microphone's
    name. A path is what exists, ends in ``.wav`` or has a slash. Raises `InvalidValue`.
    """
    if spec == NONE:
        return Nothing()
    if spec == ROS2:
        return Pushed("audio_in", clock)
    place = Path(spec).expanduser()
    if spec and ("/" in spec or place.suffix.lower() == ".wav" or place.exists()):
        return _files(place, paced, clock)
    return SoundCard(spec, clock=clock)


def _files(place: Path, paced: bool, clock: Clock | None) -> WavFiles:
    if not place.exists():
        raise InvalidValue("audio_in", str(place), "a WAV file or a folder of them that exists")
    paths = wav_files(place)
    if not paths:
        raise InvalidValue("audio_in", str(place), "a folder with WAV files in it")
    for path in paths:
        check_wav(path)
    return WavFiles(paths, paced=paced, clock=clock)
