"""Between speech output and sound card: what is to be played next, and when it will be heard."""

import threading
from collections import deque

import numpy as np

from edgevox.core.clock import Clock
from edgevox.voice.audio import Samples
from edgevox.voice.level import rms
from edgevox.voice.played_sound import PlayedSound

_FIRST_DELAY_S = 0.05
_LEAST_DELAY_S = 0.02
"""No card plays sooner what it asks for. For an echo canceller, which learns the rest of the delay,
sound may be said to be heard too early but never too late: what cards tell of it is not exact."""


class CardQueue:
    """Filled with speech, emptied by the card's own thread, which never waits for more than this.

    A card plays without end; where there is nothing to play, it plays silence.
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
        """For how long there is still something to be heard."""
        with self._lock:
            return max(0.0, self._end_s - self._clock.now())

    @property
    def level(self) -> float:
        """How loud the last samples are that the card was given."""
        return self._level
