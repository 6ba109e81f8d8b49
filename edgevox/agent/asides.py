"""Goals that move nothing and belong to no turn: they run beside whatever moves or is said."""

import threading
from collections import deque

from edgevox.agent.goals import Goal

MAX_ASIDES = 64
"""How many of them may wait."""


class Asides:
    """Runs goals one after another on a thread of its own; none pre-empts another."""

    def __init__(self) -> None:
        self._wake = threading.Condition()
        self._waiting: deque[Goal] = deque()
        self._current: Goal | None = None
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="edgevox-asides")

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Cancel everything and wait for the thread."""
        with self._wake:
            self._closed = True
            self._wake.notify_all()
        self.cancel("shutting down")
        if self._thread.is_alive():
            self._thread.join()

    @property
    def full(self) -> bool:
        """Whether one more would be dropped."""
        with self._wake:
            return len(self._waiting) >= MAX_ASIDES

    def submit(self, goal: Goal) -> None:
        """Run this goal after those that wait; where it cannot, it ends as cancelled."""
        goal.accept()
        with self._wake:
            refused = "shutting down" if self._closed else ""
            if not refused and len(self._waiting) >= MAX_ASIDES:
                refused = f"{MAX_ASIDES} goals wait already"
            if not refused:
                self._waiting.append(goal)
                self._wake.notify_all()
        if refused:
            goal.drop(refused)

    def cancel(self, reason: str) -> bool:
        """Cancel what runs and waits; True if anything did."""
        with self._wake:
            waiting = list(self._waiting)
            self._waiting.clear()
            current = self._current
            self._wake.notify_all()
        if current:
            current.token.cancel(reason)
        for goal in waiting:
            goal.drop(reason)
        return bool(current or waiting)

    @property
    def busy(self) -> bool:
        """Whether any of them runs or waits."""
        with self._wake:
            return bool(self._current or self._waiting)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until none runs or waits; False if one still did after the timeout."""
        with self._wake:
            return self._wake.wait_for(lambda: not (self._current or self._waiting), timeout_s)

    def _work(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._waiting or self._closed)
                if self._closed:
                    return
                self._current = self._waiting.popleft()
            self._current.run()
            with self._wake:
                self._current = None
                self._wake.notify_all()
