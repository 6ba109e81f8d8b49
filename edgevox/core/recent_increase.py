"""Whether a count has grown of late: a fault that is over must not be shown for ever."""

from edgevox.core.clock import Clock, SystemClock

LATELY_S = 10.0
"""For so long something that happened is shown as a fault; its count stays."""


class RecentIncrease:
    """Watches a counter that only grows. Asked from any thread."""

    def __init__(self, clock: Clock | None = None, window_s: float = LATELY_S) -> None:
        self._clock = clock or SystemClock()
        self._window_s = window_s
        self._seen = 0
        self._grew_s = float("-inf")

    def grew(self, count: int) -> bool:
        """Whether it has grown within the last seconds; `count` is what it is now."""
        now_s = self._clock.now()
        if count > self._seen:
            self._grew_s = now_s
        self._seen = max(self._seen, count)
        return now_s - self._grew_s < self._window_s
