"""A sign of life: whoever does the work beats, whoever watches asks how long ago that was."""

from collections import deque

from edgevox.core.clock import Clock, SystemClock

LATELY_S = 60.0
_MOST_BEATS = 256


class Heartbeat:
    """Counts from its making on. `beat` may be called from any thread.

    A beat that comes later than `period_s` after the one before is late.
    """

    def __init__(self, clock: Clock | None = None, period_s: float = 0.0) -> None:
        self._clock = clock or SystemClock()
        self._period_s = period_s
        self._late: deque[tuple[float, float]] = deque(maxlen=_MOST_BEATS)
        self._beat_s = self._clock.now()

    def begin(self) -> None:
        """Count from now on."""
        self._late.clear()
        self._beat_s = self._clock.now()

    def beat(self) -> None:
        """Here I am."""
        now_s = self._clock.now()
        self._late.append((now_s, now_s - self._beat_s - self._period_s))
        self._beat_s = now_s

    @property
    def silent_s(self) -> float:
        """Seconds since the last beat."""
        return max(0.0, self._clock.now() - self._beat_s)

    @property
    def lag_s(self) -> float:
        """The most by which a beat was late in the last minute, or is already."""
        now_s = self._clock.now()
        lately = [late_s for when_s, late_s in tuple(self._late) if now_s - when_s < LATELY_S]
        return max(0.0, now_s - self._beat_s - self._period_s, *lately)
