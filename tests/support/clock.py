"""The clock of tests: time stands still until the test, or a thread that waits, lets it pass."""

import itertools
import threading
from collections.abc import Callable

from edgevox.core.cancel import CancelToken


class HeldClock:
    """A `Clock` and a `Timer`. A test sets `now_s`; with `look_s` each look at it takes so long.

    `wait` is for what waits by a token: it passes the time at once. What was asked for `at` a time,
    or `set` to be done in some seconds, is done on the way, on the thread that lets time pass.
    """

    def __init__(self, now_s: float = 0.0, *, look_s: float = 0.0) -> None:
        self.now_s = now_s
        self._look_s = look_s
        self._numbers = itertools.count()
        self._alarms: list[tuple[float, int, Callable[[], object]]] = []
        self._lock = threading.Lock()

    def now(self) -> float:
        self.now_s += self._look_s
        return self.now_s

    def wait(self, token: CancelToken, seconds: float) -> bool:
        """Let time pass. Whether the token is cancelled."""
        self.advance(seconds)
        return token.cancelled

    def at(self, when_s: float, ring: Callable[[], object]) -> Callable[[], None]:
        """Call this when that time has come; returns a way to forget it."""
        with self._lock:
            entry = (when_s, next(self._numbers), ring)
            self._alarms.append(entry)
        return lambda: self._alarms.remove(entry) if entry in self._alarms else None

    def set(self, seconds: float, action: Callable[[], object]) -> Callable[[], None]:
        """Call this in so many seconds; returns a way to forget it."""
        return self.at(self.now_s + seconds, action)

    def advance(self, seconds: float) -> None:
        """Let time pass, and do what is due on the way."""
        end_s = self.now_s + seconds
        while due := [one for one in self._alarms if one[0] <= end_s + 1e-9]:
            first = min(due)
            self._alarms.remove(first)
            self.now_s = max(self.now_s, first[0])
            first[2]()
        self.now_s = max(self.now_s, end_s)

    def start(self) -> None:
        """Nothing to start."""

    def close(self) -> None:
        """Forget all that was to be done."""
        self._alarms.clear()
