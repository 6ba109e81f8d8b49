"""Something to do at a rate, on a thread of its own.

A timer of rclpy would wake the executor, which then looks at every entity of the node: about 1 ms
of CPU each time. A thread costs a twentieth of that, and publishing from it is allowed.
"""

import logging
import threading
from collections.abc import Callable

from edgevox.core.clock import Clock, SystemClock

log = logging.getLogger(__name__)


class Ticker:
    """Calls `tick` every `period_s` of real time, from `start` to `close`.

    The rate does not drift. A tick that comes too late is skipped, not made up for. One that raises
    is counted in `failures`, logged, and the next one comes.
    """

    def __init__(
        self, tick: Callable[[], None], period_s: float, name: str, clock: Clock | None = None
    ) -> None:
        self._tick = tick
        self._period_s = period_s
        self._clock = clock or SystemClock()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._work, name=name)
        self.failures = 0

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Tick no more, and wait for the tick that runs."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> None:
        due_s = self._clock.now()
        while not self._closing.wait(max(0.0, due_s - self._clock.now())):
            self._try_tick()
            missed = max(0.0, self._clock.now() - due_s) // self._period_s
            due_s += (missed + 1) * self._period_s

    def _try_tick(self) -> None:
        try:
            self._tick()
        except Exception:
            self.failures += 1
            if self.failures.bit_count() == 1:  # 1, 2, 4, 8, ...: no flood of lines
                log.exception("%s failed (%d times so far)", self._thread.name, self.failures)
