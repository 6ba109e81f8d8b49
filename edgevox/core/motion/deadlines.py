"""Deadlines: actions that run at their time unless called off, all on one sleeping thread."""

import heapq
import itertools
import math
import threading
from collections.abc import Callable

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger

log = get_logger(__name__)


class Deadlines:
    """Runs each action at its time unless it was called off, from `start` to `close`.

    An action must be quick. An action's exception is logged.
    """

    def __init__(self, name: str, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._changed = threading.Condition()
        self._set: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = itertools.count()
        self._wakes_s = math.inf
        """The clock's time when the thread wakes by itself, even if that deadline was called
        off."""
        self._closed = False
        self._thread = threading.Thread(target=self._work, name=name)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Drop all actions and wait for the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join()

    def set(self, seconds: float, action: Callable[[], None]) -> Callable[[], None]:
        """Run `action` after `seconds`. Returns a function that calls it off; does not block.

        Nearly all deadlines are called off. So the thread is woken only if it would wake too late
        by itself; of many deadlines in a row it notices only the first.
        """
        due_s = self._clock.now() + seconds
        entry = (due_s, next(self._numbers), action)
        with self._changed:
            heapq.heappush(self._set, entry)
            if due_s < self._wakes_s:
                self._wakes_s = due_s
                self._changed.notify_all()
        return lambda: self._call_off(entry)

    def _call_off(self, entry: tuple[float, int, Callable[[], None]]) -> None:
        with self._changed:
            if entry in self._set:
                self._set.remove(entry)
                heapq.heapify(self._set)

    def _work(self) -> None:
        while action := self._next():
            try:
                action()
            except Exception:
                log.exception("deadline_failed")

    def _next(self) -> Callable[[], None] | None:
        """Wait for the next due action; None after `close`."""
        with self._changed:
            while not self._closed:
                now_s = self._clock.now()
                if self._set and self._set[0][0] <= now_s:
                    return heapq.heappop(self._set)[2]
                if self._wakes_s <= now_s:
                    self._wakes_s = self._set[0][0] if self._set else math.inf
                self._changed.wait(None if self._wakes_s == math.inf else self._wakes_s - now_s)
        return None
