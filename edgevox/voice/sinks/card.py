"""A loudspeaker of this machine; a missing or unplugged one is reported and tried again.

`CardQueue`, between speech output and sound card, holds the sound to play next, and knows when it
will be heard. PortAudio plays at the device's own rate.
"""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import ChangeDetector, get_logger
from edgevox.voice import devices
from edgevox.voice.audio import Chunk, Samples, rms
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.sinks.paced import (
    AHEAD_S,
    NOTHING_S,
    PacedSink,
    RateChanger,
    Silence,
    Wait,
    real_wait,
)

log = get_logger(__name__)


_FIRST_DELAY_S = 0.05
_LEAST_DELAY_S = 0.02
"""The least delay of a card. An echo canceller learns the rest of the delay, so a reported time
may be too early but never too late: cards report it inexactly."""


class CardQueue:
    """The queue between speech and the card's own thread, which waits for nothing but the lock.

    A card plays without end; while the queue is empty, it plays silence.
    """

    def __init__(self, clock: Clock, played: PlayedSound | None = None) -> None:
        self._clock = clock
        self._played = played
        self._lock = threading.Lock()
        self._blocks: deque[Samples] = deque()
        self._waiting = 0
        self._rate_hz = 1
        self._next_s = 0.0
        self._end_s = 0.0
        self._level = 0.0
        self.filled_s = 0.0

    def open(self, rate_hz: int) -> None:
        """A card begins to play at this rate."""
        with self._lock:
            self._rate_hz = rate_hz
            self.filled_s = self._clock.now()
            self._next_s = self.filled_s + _FIRST_DELAY_S

    def add(self, samples: Samples) -> float:
        """Play these after the others; the clock's time at which the first of them is heard."""
        with self._lock:
            next_s = max(self._next_s, self._clock.now())
            start_s = next_s + self._waiting / self._rate_hz
            self._blocks.append(samples)
            self._waiting += len(samples)
            self._end_s = start_s + len(samples) / self._rate_hz
            return start_s

    def fill(self, count: int, delay_s: float) -> Samples:
        """The card's next `count` samples; the first is heard `delay_s` from now."""
        out = np.zeros(count, np.int16)
        with self._lock:
            at = 0
            while at < count and self._blocks:
                block = self._blocks[0]
                part = block[: count - at]
                out[at : at + len(part)] = part
                at += len(part)
                if len(part) == len(block):
                    self._blocks.popleft()
                else:
                    self._blocks[0] = block[len(part) :]
            self._waiting -= at
            self.filled_s = self._clock.now()
            self._next_s = self.filled_s + delay_s + count / self._rate_hz
            self._level = rms(out)
        if at and self._played:
            self._played.add(out, self._rate_hz, self.filled_s + _LEAST_DELAY_S)
        return out

    def clear(self) -> float:
        """Forget what the card was not given yet; how many seconds that is."""
        with self._lock:
            left_s = self._waiting / self._rate_hz
            self._blocks.clear()
            self._waiting = 0
            self._level = 0.0
            self._end_s = min(self._end_s, self._clock.now())
            return left_s

    def left_s(self) -> float:
        """Return for how many seconds there is still sound to hear."""
        with self._lock:
            return max(0.0, self._end_s - self._clock.now())

    @property
    def level(self) -> float:
        """The level of the last samples that the card was given."""
        return self._level


LATENCY_S = 0.04
_BLOCK_S = 0.01
_LONGEST_DELAY_S = 1.0

Fill = Callable[[int, float], Samples]
"""The next samples: how many, and how many seconds from now the first is heard."""


@dataclass(frozen=True, slots=True)
class Playback:
    """A running stream of PortAudio."""

    name: str
    rate_hz: int
    stream: Any

    @property
    def active(self) -> bool:
        return devices.is_active(self.stream)


@contextmanager
def open_loudspeaker(name: str, fill: Fill, opened: Callable[[int], None]) -> Iterator[Playback]:
    """Play on the device of this name, as `card.Opener` says it."""
    with devices.portaudio_errors():
        devices.look_again()
    with devices.in_use(), devices.portaudio_errors():
        import sounddevice

        device = devices.find(name, "output")
        channels = min(2, device.channels)
        opened(device.rate_hz)

        def callback(block: Any, frames: int, time: Any, _status: Any) -> None:
            delay_s = time.outputBufferDacTime - time.currentTime
            block[:] = fill(frames, min(max(delay_s, 0.0), _LONGEST_DELAY_S))[:, None]

        try:
            with sounddevice.OutputStream(
                device=device.index,
                samplerate=device.rate_hz,
                channels=channels,
                dtype="int16",
                blocksize=int(_BLOCK_S * device.rate_hz),
                latency=LATENCY_S,
                callback=callback,
            ) as stream:
                try:
                    yield Playback(device.name, device.rate_hz, stream)
                finally:
                    stream.abort()  # to stop it would wait for a device that may be gone
        except sounddevice.PortAudioError as error:
            raise DeviceMissing(f"{device.name} cannot be opened: {error}") from None


DEAF_S = 1.0
"""A card that asks for no samples for this long is lost: PortAudio does not always say so."""
_STEP_S = 0.02


class PlaybackStream(Protocol):
    """A card that plays."""

    @property
    def name(self) -> str: ...

    @property
    def rate_hz(self) -> int: ...

    @property
    def active(self) -> bool:
        """False once PortAudio itself has given it up."""


Opener = Callable[[str, Fill, Callable[[int], None]], AbstractContextManager[PlaybackStream]]
"""Opens the device of a name, tells its rate, and asks for samples until the context ends.

Raises `DeviceMissing`.
"""


class SoundCardSink:
    """Plays on the device whose name is, or contains, `device`; on the default one if empty.

    The device is opened at once. While it is missing, speech takes its time in silence. `played` is
    told what was played.
    """

    def __init__(
        self,
        device: str = "",
        *,
        opener: Opener = open_loudspeaker,
        clock: Clock | None = None,
        wait: Wait = real_wait,
        retry_s: float = RETRY_S,
        played: PlayedSound | None = None,
    ) -> None:
        self.name = device or "the default loudspeaker"
        self._device = device
        self._opener = opener
        self._clock = clock or SystemClock()
        self._wait = wait
        self._retry_s = retry_s
        self._queue = CardQueue(self._clock, played)
        self._silence = PacedSink(Silence(), clock=self._clock, wait=wait)
        self._rate = RateChanger(1)
        self._stream: PlaybackStream | None = None
        self._opened = ExitStack()
        self._tried_s = float("-inf")
        self._is_news = ChangeDetector()
        self._fault = ""
        self._keep_open()

    @property
    def fault(self) -> str:
        """The reason why nothing can be heard, as of the last sentence; empty while it plays."""
        stream = self._stream
        return self._fault if stream is None or self._alive() else f"{stream.name} plays no more"

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        self._keep_open()
        if self._stream is None:
            return self._silence.play(chunk, token)
        if token.cancelled:
            return self._clock.now()
        start_s = self._queue.add(self._rate.push(chunk))
        self._wait_until(AHEAD_S, token)
        return start_s

    def drain(self, token: CancelToken) -> None:
        if self._stream is None:
            self._silence.drain(token)
            return
        self._queue.add(self._rate.flush())
        self._wait_until(0.0, token)

    def stop(self) -> float:
        return self._queue.clear() + self._silence.stop()

    def audible(self) -> float:
        return self._queue.level if self._stream else 0.0

    def close(self) -> None:
        self._stream = None
        with suppress(DeviceMissing):  # it may be gone already
            self._opened.close()
        self._silence.close()

    def _wait_until(self, ahead_s: float, token: CancelToken) -> None:
        while not token.cancelled and self._alive():
            left_s = self._queue.left_s() - ahead_s
            if left_s < NOTHING_S:
                return
            self._wait(token, min(left_s, _STEP_S))

    def _alive(self) -> bool:
        stream = self._stream
        asked = self._clock.now() - self._queue.filled_s <= DEAF_S
        return stream is not None and stream.active and asked

    def _keep_open(self) -> None:
        """Open the device if it is time to try, and give up one that has gone."""
        if self._stream and not self._alive():
            self._lose(f"{self._stream.name} plays no more")
        if self._stream is None and self._clock.now() - self._tried_s >= self._retry_s:
            self._tried_s = self._clock.now()
            self._open()

    def _open(self) -> None:
        try:
            opener = self._opener(self._device, self._queue.fill, self._queue.open)
            self._stream = self._opened.enter_context(opener)
        except DeviceMissing as error:
            self._fault = str(error)
            if self._is_news(self._fault):
                log.warning("loudspeaker_missing", reason=self._fault, retry_s=self._retry_s)
            return
        self._fault = ""
        self._rate = RateChanger(self._stream.rate_hz)
        if self._is_news("open", self._stream.name):
            log.info("loudspeaker_open", device=self._stream.name)

    def _lose(self, why: str) -> None:
        self._stream = None
        self._queue.clear()
        try:
            self._opened.close()
        except DeviceMissing as error:
            why = str(error)
        self._fault = why
        if self._is_news(why):
            log.warning("loudspeaker_lost", reason=why, retry_s=self._retry_s)
