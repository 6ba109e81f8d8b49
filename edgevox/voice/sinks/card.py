"""A loudspeaker of this machine; one that is missing or pulled out is said and tried again."""

from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, suppress
from typing import Protocol

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import ChangeDetector, get_logger
from edgevox.voice.audio import Chunk
from edgevox.voice.devices import RETRY_S, DeviceMissing
from edgevox.voice.played_sound import PlayedSound
from edgevox.voice.sinks.card_queue import CardQueue
from edgevox.voice.sinks.paced import PacedSink
from edgevox.voice.sinks.paced_output import Silence
from edgevox.voice.sinks.pacing import AHEAD_S, NOTHING_S, RateChanger, Wait, real_wait
from edgevox.voice.sinks.portaudio_playback import Fill, open_loudspeaker

log = get_logger(__name__)

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
    """Plays on the device whose name is, or contains, `device`; on the default if empty.

    It is opened at once. While it is missing, speech takes its time in silence. What it plays is
    told to `played`.
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
        """Why nothing can be heard of it now, as of the last sentence; empty while it plays."""
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
