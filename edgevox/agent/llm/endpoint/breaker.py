"""Leaves alone for a while what has just failed."""

import threading

from edgevox.core.clock import Clock, SystemClock

FIRST_REST_S, LONGEST_REST_S = 15.0, 240.0


class Breaker:
    """A circuit breaker: each failure on end doubles the rest, one success ends it."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._lock = threading.Lock()
        self._rest_s = 0.0
        self._until_s = 0.0

    @property
    def resting(self) -> bool:
        """Whether it is too early to try again."""
        return self._rest_s > 0 and self._clock.now() < self._until_s

    def failed(self) -> bool:
        """It failed; True if it had not before."""
        with self._lock:
            first = self._rest_s == 0
            self._rest_s = FIRST_REST_S if first else min(2 * self._rest_s, LONGEST_REST_S)
            self._until_s = self._clock.now() + self._rest_s
            return first

    def succeeded(self) -> bool:
        """It worked; True if it had failed before."""
        with self._lock:
            recovered = self._rest_s > 0
            self._rest_s = 0.0
            return recovered
