"""A microphone of this machine; one that is missing or pulled out is said and tried again."""

import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import ChangeDetector, get_logger
from edgevox.voice.audio import Frame, Samples
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.sources.portaudio_capture import open_microphone
from edgevox.voice.sources.pushed import Pushed

log = get_logger(__name__)

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
        """Why nothing is heard now; empty while the device is open."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._keep_open, name="edgevox-microphone")

    @property
    def dropped(self) -> int:
        """Frames that nobody read in time."""
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
