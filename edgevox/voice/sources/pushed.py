"""A source that a callback fills: of the sound card, or of a ROS 2 subscription."""

import threading
from collections import deque
from dataclasses import replace

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger
from edgevox.voice.audio import Frame, Framer, Samples, UtteranceOver

log = get_logger(__name__)

MAX_FRAMES = 64
"""2 s of sound may wait to be read; beyond that, the oldest frame is dropped and counted. The
end of an utterance is never dropped."""


class Pushed:
    """A bounded queue of frames. `push` never blocks; one thread pushes, another reads."""

    def __init__(self, name: str, clock: Clock | None = None) -> None:
        self.name = name
        self.dropped = 0
        self._clock = clock or SystemClock()
        self._framer = Framer()
        self._frames: deque[Frame | UtteranceOver] = deque()
        self._arrived = threading.Condition()
        self._closed = False

    def start(self) -> None:
        """Do nothing: the pushing program decides when sound comes."""

    def push(self, samples: Samples, *, addressed: bool = False) -> None:
        """Take mono samples at 16 kHz, the last one heard now; see `Frame.addressed`."""
        frames = list(self._framer.push(samples, self._clock.now()))
        with self._arrived:
            if self._closed or not frames:
                return
            self._frames.extend(replace(one, addressed=addressed) for one in frames)
            waiting = sum(isinstance(one, Frame) for one in self._frames)
            lost = max(0, waiting - MAX_FRAMES)
            for _ in range(lost):
                self._drop_oldest()
            self._arrived.notify()
        if lost:
            self._count(lost)

    def interrupted(self) -> None:
        """Mark a gap: the next samples do not follow on the last."""
        self._framer.reset()

    def end(self) -> None:
        """End the utterance after the samples that were pushed last."""
        self._put(UtteranceOver(self.name, abandoned=False))

    def abandon(self) -> None:
        """Abandon the utterance: the speaker is gone, and unread sound is forgotten."""
        self._put(UtteranceOver(self.name, abandoned=True))

    def read(self, timeout_s: float) -> Frame | None:
        """The oldest frame; None if there was none in time.

        Raises `UtteranceOver` after `end` and `abandon`.
        """
        with self._arrived:
            self._arrived.wait_for(lambda: self._frames or self._closed, timeout_s)
            first = self._frames.popleft() if self._frames else None
        if isinstance(first, UtteranceOver):
            raise first
        return first

    def close(self) -> None:
        """Take nothing more and wake the reader."""
        with self._arrived:
            self._closed = True
            self._frames.clear()
            self._arrived.notify_all()

    def _put(self, over: UtteranceOver) -> None:
        self._framer.reset()
        with self._arrived:
            if self._closed:
                return
            if over.abandoned:
                self._frames.clear()
            if not (self._frames and isinstance(self._frames[-1], UtteranceOver)):
                self._frames.append(over)
            self._arrived.notify()

    def _drop_oldest(self) -> None:
        """Drop the oldest frame; an utterance's end among the dropped items is kept, once."""
        over = None
        while isinstance(first := self._frames.popleft(), UtteranceOver):
            over = first if over is None or first.abandoned else over
        if over:
            self._frames.appendleft(over)

    def _count(self, lost: int) -> None:
        before, self.dropped = self.dropped, self.dropped + lost
        if self.dropped.bit_length() > before.bit_length():  # a flood leaves a few lines
            log.warning("frames_dropped", source=self.name, dropped=self.dropped)
