"""A ticker: jobs at fixed rates, all on one thread.

A timer of rclpy would wake the executor, which then looks at every entity of the node: about 1 ms
of CPU each time. A thread costs a twentieth of that, and publishing from it is allowed. Jobs due at
the same time share one waking, since waking costs more than most of the jobs.
"""

import threading
from collections.abc import Callable

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger, worth_a_line

log = get_logger(__name__)

MakeTicker = Callable[[str], "Ticker"]
"""Makes a ticker by the name of its thread, for a part that needs its own."""
TOGETHER_S = 0.001
"""Jobs due within this time run together."""


class _TickerJob:
    """Something to do, and when the next time."""

    def __init__(self, tick: Callable[[], None], period_s: float, due_s: float) -> None:
        self.tick, self.period_s, self.due_s = tick, period_s, due_s

    def advance(self, now_s: float) -> None:
        """Set the next due time; missed ones are skipped."""
        missed = max(0.0, now_s - self.due_s) // self.period_s
        self.due_s += (missed + 1) * self.period_s


class Ticker:
    """Runs jobs, each at its period of real time in seconds, on one thread from `start` to `close`.

    A rate does not drift. A late tick is skipped, not made up for. A tick that raises is counted in
    `failures` and logged, and the next one comes. Jobs should be quick, because a slow one delays
    the others. A test that turns the clock calls `begin` and then `tick` instead of `start`.
    """

    def __init__(self, name: str, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._closing = threading.Event()
        self._ticking = threading.RLock()
        self._jobs: tuple[_TickerJob, ...] = ()
        self._thread = threading.Thread(target=self._work, name=name)
        self.failures = 0

    def every(self, period_s: float, tick: Callable[[], None]) -> Callable[[], None]:
        """Call `tick` every `period_s`, the first time at the start; call this before `start`.

        Returns a way to end it, which waits for the tick that runs.
        """
        job = _TickerJob(tick, period_s, self._clock.now())
        self._jobs = (*self._jobs, job)
        return lambda: self._forget(job)

    def start(self) -> None:
        self.begin()
        self._thread.start()

    def begin(self) -> None:
        """Every job is due now."""
        now_s = self._clock.now()
        for job in self._jobs:
            job.due_s = now_s

    def tick(self) -> float | None:
        """Run the due jobs; return the seconds until the next one, None without any."""
        now_s = self._clock.now()
        for job in self._jobs:
            if job.due_s <= now_s + TOGETHER_S:
                self._try_tick(job)
                job.advance(self._clock.now())
        if not self._jobs:
            return None
        return max(0.0, min(job.due_s for job in self._jobs) - self._clock.now())

    def close(self) -> None:
        """Tick no more, and wait for the tick that runs."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> None:
        wait_s: float | None = 0.0
        while not self._closing.wait(wait_s):
            wait_s = self.tick()

    def _forget(self, job: _TickerJob) -> None:
        with self._ticking:
            self._jobs = tuple(one for one in self._jobs if one is not job)

    def _try_tick(self, job: _TickerJob) -> None:
        try:
            with self._ticking:
                if job in self._jobs:
                    job.tick()
        except Exception:
            self.failures += 1
            if worth_a_line(self.failures):
                log.exception("tick_failed", ticker=self._thread.name, failures=self.failures)
