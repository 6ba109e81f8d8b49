"""A microphone of this machine; a missing or unplugged one is reported and tried again."""

import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import ChangeDetector, get_logger
from edgevox.voice import devices
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Frame, Samples
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.wav import Resampler

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
    """Capture from the device of this name, as `soundcard.Opener` says it."""
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
