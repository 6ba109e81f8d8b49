"""A source that a callback fills: of the sound card, or of a ROS 2 subscription."""

import threading
from collections import deque
from dataclasses import replace

import numpy as np

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger
from edgevox.voice.audio import FULL_SCALE, RATE_HZ, Frame, Framer, Samples, UtteranceOver, rms

log = get_logger(__name__)

MAX_FRAMES = 64
"""2 s of sound may wait to be read; beyond that, the oldest frame is dropped and counted. The
end of an utterance is never dropped."""


WINDOW_S = 5.0
"""Seconds of sound without a gap after which its form is judged."""
_GAP_S = 1.0
_ODD_RATE = 1.25
_LOUD, _ALIKE, _NOISY = 0.2, 0.3, 0.3
"""Sound of another form is loud noise for this part of the time: one sample tells little of the
next."""


class FormCheck:
    """Judges by the clock, and by how loud it is, whether what comes is what it should be.

    That is 16 kHz, mono, 16 bit little-endian. Sound of another form goes unnoticed otherwise: the
    robot is deaf, and everything works.
    """

    def __init__(self) -> None:
        self._begun_s: float | None = None
        self._last_s = 0.0
        self._size = self._loud = 0

    def judge(self, samples: Samples, now_s: float) -> str | None:
        """What is wrong, or "" if nothing is; None until a window is over."""
        if self._begun_s is None or now_s - self._last_s > _GAP_S:  # this came before the window
            self._begun_s, self._size, self._loud = now_s, 0, 0
            self._last_s = now_s
            return None
        self._last_s = now_s
        self._size += samples.size
        self._loud += samples.size * _is_loud_noise(samples)
        passed_s = now_s - self._begun_s
        if passed_s < WINDOW_S:
            return None
        rate_hz, noise = self._size / passed_s, self._loud > _NOISY * self._size
        self._begun_s = None
        wanted = f"expected {RATE_HZ} Hz, mono, 16 bit little-endian"
        if noise:
            return f"noise at full scale, as of floats, another byte order or MP3; {wanted}"
        if not RATE_HZ / _ODD_RATE <= rate_hz <= RATE_HZ * _ODD_RATE:
            return f"{round(rate_hz, -2):.0f} samples a second; {wanted}"
        return ""


def _is_loud_noise(samples: Samples) -> bool:
    level = rms(samples)
    if level < _LOUD:
        return False
    wide = samples / FULL_SCALE
    return abs(float(np.mean(wide[1:] * wide[:-1]))) < _ALIKE * level**2


class Pushed:
    """A bounded queue of frames. `push` never blocks; one thread pushes, another reads."""

    def __init__(self, name: str, clock: Clock | None = None) -> None:
        self.name = name
        self.dropped = 0
        self.doubt = ""
        """What is odd about the sound that comes; empty if nothing is."""
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
