"""The clock of tests: time that stands still until the test, or whoever waits, lets it pass."""

from collections.abc import Callable

from edgevox.core.cancel import CancelToken


class HeldClock:
    """A `Clock`. A test sets `now_s`; with `look_s` each look at it takes so long.

    `wait` is for what waits by a token: it passes the time at once, and calls on the way what was
    asked for `at` a time.
    """

    def __init__(self, now_s: float = 0.0, *, look_s: float = 0.0) -> None:
        self.now_s = now_s
        self._look_s = look_s
        self._alarms: list[tuple[float, Callable[[], None]]] = []

    def now(self) -> float:
        self.now_s += self._look_s
        return self.now_s

    def wait(self, token: CancelToken, seconds: float) -> bool:
        """Let time pass; alarms ring on the thread that waits. Whether the token is cancelled."""
        self.now_s += seconds
        for alarm in [one for one in self._alarms if one[0] <= self.now_s + 1e-9]:
            self._alarms.remove(alarm)
            alarm[1]()
        return token.cancelled

    def at(self, when_s: float, ring: Callable[[], None]) -> None:
        """Call this when that time has come."""
        self._alarms.append((when_s, ring))
