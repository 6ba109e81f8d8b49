"""The loop that lets a simulated world's time pass, in real time or as fast as possible.

`SimulatedBody` switches a simulated body on and off. `SimComponent` is a robot's status, simulated
or not: the component `sim`.
"""

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Self

from edgevox.agent.text.reasons import because, called_off
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.status import (
    ComponentName,
    Finding,
    HealthCheck,
    Level,
    RecentIncrease,
    ReportsDoubts,
    Status,
    fault_of,
    moves,
    stall,
)
from edgevox.robots.capabilities import (
    Body,
    CountsHalts,
    KeepsPace,
    RemembersPlaces,
    TellsStalls,
    charge_of,
)

log = get_logger(__name__)


class SimulatedBody(ABC):
    """Runs from `start` to `close`, and for so long in a ``with``."""

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @abstractmethod
    def start(self) -> None:
        """Let time pass in its world."""

    @abstractmethod
    def halt(self, reason: str) -> bool:
        """See `Body.halt`."""

    def close(self) -> None:
        """Stop moving, and join all threads. What runs ends as cancelled."""
        self.halt(str(called_off("switched_off")))
        self._close()

    @abstractmethod
    def _close(self) -> None:
        """Join all threads: it is halted."""


SLOW = 0.9
"""A world that keeps less than this part of its pace is slow."""
LOW_BATTERY = 0.15


class SimComponent:
    """Standing still, breaking and having no robot are errors; being slow is a warning."""

    name = ComponentName.SIM

    def __init__(self, body: Body, clock: Clock | None = None) -> None:
        self._body = body
        self._breaking = RecentIncrease(clock)
        self.checks = (
            (HealthCheck("body", moves(lambda: body.stalled_s)),)
            if isinstance(body, TellsStalls)
            else ()
        )

    def status(self) -> Status:
        """Return the current status. A stalled world may hold the lock that guards its battery."""
        body, steps = self._body, self._body if isinstance(self._body, KeepsPace) else None
        stalled_s = body.stalled_s if isinstance(body, TellsStalls) else 0.0
        breaks = steps.breaks if steps else 0
        found = stall(stalled_s, "the world has")
        battery = None if found else charge_of(body)
        if fault := fault_of(body):
            found.append(Finding(Level.ERROR, fault))
        if isinstance(body, ReportsDoubts):
            found += [Finding(Level.WARN, doubt) for doubt in body.doubts]
        if isinstance(body, RemembersPlaces) and (fault := body.place_memory.fault):
            found.append(Finding(Level.WARN, fault))
        if self._breaking.grew(breaks):
            text = f"its numbers broke and it was put back, {breaks} times by now"
            found.append(Finding(Level.ERROR, text))
        if steps and steps.pace is not None and steps.pace < SLOW:
            found.append(Finding(Level.WARN, f"slow: keeps {100 * steps.pace:.0f} % of its pace"))
        if battery is not None and battery < LOW_BATTERY:
            level = Level.WARN if battery else Level.ERROR
            found.append(Finding(level, f"battery at {100 * battery:.0f} %"))
        return Status.judged(
            self.name,
            found,
            well="runs",
            body=body.name,
            **({"real_time_factor": steps.real_time_factor or None} if steps else {}),
            stalled_s=stalled_s,
            broke=breaks,
            battery=battery,
            **({"watchdog_halts": body.watchdog_halts} if isinstance(body, CountsHalts) else {}),
        )


MOST_LAG_S = 0.25
"""The most time that a stalled thread catches up; older time is dropped."""
BROKE = because("broke")
"""The spoken reason of a goal that fails with a broken step."""
_PAUSE_AFTER_FAILURE_S = 0.05
_FACTOR_OVER_S = 1.0
_LOOK_S = 0.1
"""Seconds between updates of a world at rest; far less than `MOST_LAG_S`."""


class Pacer:
    """Says when the next step is due, so that `speed` seconds of the world pass each second."""

    def __init__(self, period_s: float, now_s: float) -> None:
        self._period_s = period_s
        self._due_s = now_s

    def wait_s(self, now_s: float) -> float:
        """Seconds until the next step is due; 0 or less means now."""
        late = now_s - self._due_s
        if late > MOST_LAG_S:
            self._due_s = now_s - MOST_LAG_S
        return self._due_s - now_s

    def due(self, now_s: float) -> bool:
        """Return whether a step is due. Called all the time.

        It takes no lock and changes nothing.
        """
        return now_s >= self._due_s

    def stepped(self) -> None:
        """A step was taken."""
        self._due_s += self._period_s


class SimLoop:
    """Calls `step` again and again on its own thread.

    Args:
        step: Lets `period_s` of the world's time pass; returns whether it has more to do.
        period_s: Seconds of the world's time per step.
        speed: The multiple of real time at which it steps, busy or not. None steps without a pause
            while it is busy; otherwise the world stands still until `wake` or `advance`. With 0
            time passes only as far as `advance` asks: the simulation is in lockstep with its
            caller, and the caller's work between two calls takes no simulated time.
        clock: The time; the system's by default.
        sleep: Waits for some seconds.
        name: Names the thread.
        broke: Stops all motion after a step that raised; that is logged and counted, and the next
            step comes.
        rests: Whether the next step changes nothing but the time. Waking the thread for each such
            step would cost more than the steps do. Due steps are then taken together, now and then,
            or by a reader of the time, who calls `catch_up` first.
        lock: The body's own, reentrant.
    """

    def __init__(
        self,
        step: Callable[[], bool],
        *,
        period_s: float,
        speed: float | None = 1.0,
        clock: Clock | None = None,
        sleep: Callable[[float], None] | None = None,
        name: str = "world",
        broke: Callable[[], object] = lambda: None,
        rests: Callable[[], bool] = lambda: False,
        lock: AbstractContextManager[object] | None = None,
    ) -> None:
        if speed is not None and not 0.0 <= speed <= 1000.0:
            raise InvalidValue("speed", speed, "a number from 0 to 1000, or None")
        self._step, self._broke, self._rests = step, broke, rests
        self._lock = lock or threading.RLock()
        self._period_s = period_s
        self._speed = speed
        self._clock = clock or SystemClock()
        self._sleep = sleep or self._wait_for_close
        self._closing = threading.Event()
        self._woken = threading.Event()
        self._stepped = threading.Condition()
        self._steps = 0
        self._wanted_steps = 0
        self._waiting: list[int] = []
        self._next_waking = math.inf
        self._thread = threading.Thread(target=self._run, name=name)
        self._pacer: Pacer | None = None
        self._meter = _RateMeter(0.0)
        self._factor = 0.0
        self._due_s: float | None = None
        self.failures = 0

    @property
    def running(self) -> bool:
        """Whether steps are being taken."""
        return self._thread.is_alive() and not self._closing.is_set()

    @property
    def real_time_factor(self) -> float:
        """World seconds per second, over the last second or so; 0 until that is known."""
        return self._factor

    @property
    def pace(self) -> float | None:
        """The share of the wanted speed that it keeps; None without a wanted speed, or not yet."""
        return self._factor / self._speed if self._speed and self._factor else None

    @property
    def stalled_s(self) -> float:
        """Seconds for which a step has been due that has not ended well.

        0 for a world that rests by design; infinite if its thread died.
        """
        due_s = self._due_s
        if self._closing.is_set() or self._thread.ident is None:
            return 0.0
        if not self._thread.is_alive():
            return math.inf
        return 0.0 if due_s is None else max(0.0, self._clock.now() - due_s)

    def start(self) -> None:
        now_s = self._clock.now()
        self._pacer = Pacer(self._period_s / self._speed, now_s) if self._speed else None
        self._meter = _RateMeter(now_s)
        self._thread.start()

    def wake(self) -> None:
        """Tell the loop that there is work."""
        self._woken.set()

    def catch_up(self) -> None:
        """Take the due steps of a world at rest; do nothing in one that moves."""
        pacer = self._pacer
        if pacer is None or not pacer.due(self._clock.now()) or not self._resting:
            return
        with self._lock:
            while self._resting and self._wait_s() <= 0.0:
                self._take_step()

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed, or no more steps are taken."""
        with self._stepped:
            until = self._steps + max(1, round(seconds / self._period_s))
            self._wanted_steps = max(self._wanted_steps, until)
            self._waiting.append(until)
            self._next_waking = min(self._waiting)
            self._woken.set()
            self._stepped.wait_for(lambda: self._steps >= until or not self.running)
            self._waiting.remove(until)
            self._next_waking = min(self._waiting, default=math.inf)

    def close(self) -> None:
        """Take no more steps and wait for the thread to end."""
        self._closing.set()
        self._woken.set()
        with self._stepped:
            self._stepped.notify_all()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        while not self._closing.is_set():
            if self._woken.is_set():
                self._woken.clear()
            if self._resting:
                self.catch_up()
                if self._resting:
                    self._woken.wait(_LOOK_S)
            elif (wait_s := self._wait_s()) > 0.0:
                self._sleep(wait_s)
            elif self._speed == 0.0 and not self._asked_for:
                self._woken.wait()
            else:
                self._go_on()

    def _go_on(self) -> None:
        failures = self.failures
        more = self._take_step()
        if self.failures > failures:
            self._sleep(_PAUSE_AFTER_FAILURE_S)
        elif self._pacer is None and not (more or self._asked_for):
            self._woken.wait()

    def _wait_s(self) -> float:
        """Seconds until the clock wants the next step; 0 where none is followed."""
        return self._pacer.wait_s(self._clock.now()) if self._pacer else 0.0

    @property
    def _resting(self) -> bool:
        """Whether the world follows a clock and only its time is to change."""
        follows = self._pacer is not None and not self._closing.is_set()
        return follows and self._rests() and not self._asked_for

    def _take_step(self) -> bool:
        with self._lock:
            more = self._try_step()
            self._count()
            self._factor = self._meter.factor(self._clock.now(), self._period_s)
            if self._pacer is not None:
                self._pacer.stepped()
            return more

    @property
    def _asked_for(self) -> bool:
        """Whether `advance` waits for more steps."""
        return self._steps < self._wanted_steps

    def _count(self) -> None:
        """A step is over; those who waited for it are woken, and nobody else.

        No lock is taken for the others: `advance` looks at the steps after it has said what it
        waits for, this looks at who waits after it has counted, so one of them sees the other.
        """
        self._steps += 1
        if self._steps >= self._next_waking:
            with self._stepped:
                self._stepped.notify_all()

    def _try_step(self) -> bool:
        if self._due_s is None:
            self._due_s = self._clock.now()
        try:
            more = self._step()
        except Exception:
            self.failures += 1
            if worth_a_line(self.failures):
                log.exception("world_step_failed", failures=self.failures)
            self._broke()
            return True
        self._due_s = None
        return more

    def _wait_for_close(self, seconds: float) -> None:
        self._closing.wait(seconds)


class SteppedBySimLoop:
    """Status of a body with a `SimLoop`, as `KeepsPace` and `TellsStalls` define it."""

    _sim_loop: SimLoop

    @property
    def real_time_factor(self) -> float:
        """Seconds that pass in the world each second."""
        return self._sim_loop.real_time_factor

    @property
    def pace(self) -> float | None:
        """The share of the wanted speed that it keeps; None without a wanted speed, or not yet."""
        return self._sim_loop.pace

    @property
    def breaks(self) -> int:
        """The number of the world's steps that failed, or whose numbers broke."""
        return self._sim_loop.failures

    @property
    def stalled_s(self) -> float:
        """Seconds for which a step has been due that has not ended well."""
        return self._sim_loop.stalled_s


class _RateMeter:
    """World seconds per second."""

    def __init__(self, now_s: float) -> None:
        self._since_s = now_s
        self._steps = 0
        self._factor = 0.0

    def factor(self, now_s: float, period_s: float) -> float:
        self._steps += 1
        passed = now_s - self._since_s
        if passed >= _FACTOR_OVER_S:
            self._factor = self._steps * period_s / passed
            self._since_s, self._steps = now_s, 0
        return self._factor
