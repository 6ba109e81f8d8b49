"""Where programs are kept: each is put there once, taken once, and told of on the bus.

A program that is kept: what is left of it, when it is due, and how far it is.

How much a program may be: what is more is refused, with a reason.

What programs wait for besides time: a battery that gets low, a goal that ends.
"""

import threading
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from edgevox.agent.goals.executor import MAX_CALLS
from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.orders import (
    After,
    Again,
    BatteryBelow,
    Program,
    Repeat,
    Return,
    When,
    calls_of,
    parts_of,
)
from edgevox.agent.programs.senses import Senses
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.skills.going import no_way_back
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import GOAL_ENDS, GoalStatus, ProgramChanged, ProgramStatus
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.reason import Reason
from edgevox.core.ways import Way


def _nothing() -> None:
    """There is nothing to call off."""


@dataclass(eq=False, slots=True)
class Kept:
    """One program from its order to its end. Only who keeps it changes it.

    `program` is what is left of it: without the delay, once that is over. `due_s` is the clock's
    time when it goes on by itself, `goal` what runs its steps, `round` how often they were begun.
    `way` is how it was asked for, in which `turn` and at which `mark` of the interlock, and
    `confirmed` whether somebody said yes to it.
    """

    id: str
    program: Program
    turn: int
    way: Way
    mark: int
    confirmed: bool = False
    due_s: float | None = None
    round: int | None = None
    goal: Goal | None = None
    call_off: Callable[[], None] = field(default=_nothing)

    @property
    def status(self) -> ProgramStatus:
        """What it does while it is kept."""
        return ProgramStatus.RUNNING if self.goal else ProgramStatus.WAITING


MAX_PROGRAMS = 8
"""How many programs may wait and run at a time."""
MAX_TIMES = 100
"""How often a program may repeat its steps, if it does not do so until it is stopped."""
LONGEST_WAIT_S = 24 * 3600.0
"""How long a program may wait for its time, or for what it waits for to be so."""
LONGEST_RUN_S = 8 * 3600.0
"""How long a program may run."""


def check_bounds(program: Program, senses: Senses, skills: Collection[Skill]) -> None:
    """Raise `SkillFailed` with the reason for a program that is too much, or cannot be.

    `skills` are all that the robot has.
    """
    if len(calls_of(program)) > MAX_CALLS:
        raise SkillFailed(because("program_long", count=str(MAX_CALLS)))
    delays_s = [one.delay_s for one in parts_of(program) if isinstance(one, After)]
    if sum(delays_s) > LONGEST_WAIT_S:
        raise SkillFailed(because("program_late", hours=f"{LONGEST_WAIT_S / 3600:g}"))
    for one in parts_of(program):
        _check_part(one, senses, skills)


def _check_part(part: Program, senses: Senses, skills: Collection[Skill]) -> None:
    match part:
        case Repeat(count=float() | int() as count) if not (
            count == int(count) and 1 <= count <= MAX_TIMES
        ):
            raise SkillFailed(because("program_times", said=f"{count:g}", count=str(MAX_TIMES)))
        case When(condition=BatteryBelow()) if senses.battery is None:
            raise SkillFailed(because("no_battery"))
        case When(condition=BatteryBelow(percent=percent)) if not 0 < percent < 100:
            raise SkillFailed(because("program_percent", said=f"{percent:g}"))
        case Return() if senses.way_back() is None:
            raise SkillFailed(no_way_back(skills))
        case Again():
            raise SkillFailed(because("nothing_before"))


_TENTHS = 1


class Timer(Protocol):
    """Does things later, on one thread that else sleeps: `Deadlines` is one."""

    def start(self) -> None: ...

    def close(self) -> None: ...

    def set(self, seconds: float, action: Callable[[], None]) -> Callable[[], None]:
        """Do it after so many seconds. Returns a way to call it off."""


class ProgramStore:
    """The programs that wait and run, in the order of their orders. Any thread may ask.

    `describe` says a program in words.
    """

    def __init__(
        self, bus: Bus, clock: Clock, timer: Timer, describe: Callable[[Program], str]
    ) -> None:
        self._bus = bus
        self._clock = clock
        self._timer = timer
        self._describe = describe
        self._lock = threading.Lock()
        self._telling = threading.RLock()
        self._kept: dict[str, Kept] = {}

    @property
    def all(self) -> Sequence[Kept]:
        """Those that wait and run."""
        with self._lock:
            return tuple(self._kept.values())

    def has(self, kept: Kept) -> bool:
        """Whether it was not taken yet."""
        with self._lock:
            return kept.id in self._kept

    def put(self, kept: Kept, asked: CancelToken) -> bool:
        """Keep it, unless who asked was stopped; raises `SkillFailed` where there is no room."""
        with self._lock:
            if asked.cancelled:
                return False
            if len(self._kept) >= MAX_PROGRAMS:
                raise SkillFailed(because("programs_full", count=str(MAX_PROGRAMS)))
            self._kept[kept.id] = kept
            return True

    def take(self, kept: Kept) -> bool:
        """Keep it no longer; False if it was taken before."""
        with self._lock:
            taken = self._kept.pop(kept.id, None) is not None
            if taken:
                kept.call_off()
            return taken

    def later(self, kept: Kept, seconds: float, action: Callable[[], None]) -> None:
        """Do this after so many seconds if it is kept then, instead of what was to be done."""
        with self._lock:
            if kept.id in self._kept:
                kept.call_off()
                kept.call_off = self._timer.set(seconds, action)

    def text(self, kept: Kept) -> str:
        """What it will do from now on, as a person is told."""
        left = kept.program
        if isinstance(left, After) and kept.due_s is not None:
            left = After(max(0.0, kept.due_s - self._clock.now()), left.program)
        return self._describe(left)

    def event(
        self, kept: Kept, status: ProgramStatus | None = None, reason: Reason | None = None
    ) -> ProgramChanged:
        """How it is, as an event."""
        due_in_s = None
        if kept.due_s is not None and status is None:
            due_in_s = round(max(0.0, kept.due_s - self._clock.now()), _TENTHS)
        now = status or kept.status
        return ProgramChanged(
            kept.id, self.text(kept), now, kept.turn, due_in_s, kept.round, reason
        )

    def tell(
        self, kept: Kept, end: ProgramStatus | None = None, reason: Reason | None = None
    ) -> None:
        """Say on the bus how it is, or how it ended, which is the last that is told of it."""
        with self._telling:
            if end is not None or self.has(kept):
                self._bus.publish(self.event(kept, end, reason))


LOOK_EVERY_S = 5.0
"""How often the battery is looked at while a program waits for it."""


class Waits:
    """Calls `met` once with each program for which it has come true, `missed` where it cannot."""

    def __init__(
        self,
        store: ProgramStore,
        timer: Timer,
        senses: Senses,
        met: Callable[[Kept], None],
        missed: Callable[[Kept], None],
    ) -> None:
        self._store = store
        self._timer = timer
        self._senses = senses
        self._met = met
        self._missed = missed
        self._lock = threading.Lock()
        self._looks = False
        self._goals: dict[str, tuple[Goal, Kept]] = {}

    def for_battery(self) -> None:
        """Look at the battery, now and as long as a program waits for it."""
        with self._lock:
            begins, self._looks = not self._looks, True
        if begins:
            self._timer.set(0.0, self._look)

    def for_goal(self, kept: Kept, goal: Goal) -> None:
        """Wait for the end of this goal."""
        with self._lock:
            self._goals[kept.id] = (goal, kept)
        goal.token.on_cancel(lambda: self._over(goal, self._missed))
        if goal.status in GOAL_ENDS:
            self.goal_ended(goal)

    def goal_ended(self, goal: Goal) -> None:
        """A goal has ended, and what there is to say of it was said."""
        arrived = goal.status is GoalStatus.SUCCEEDED
        self._over(goal, self._met if arrived else self._missed)

    def _over(self, goal: Goal, then: Callable[[Kept], None]) -> None:
        with self._lock:
            ended = [kept for waited, kept in self._goals.values() if waited is goal]
            for kept in ended:
                del self._goals[kept.id]
        for kept in ended:
            then(kept)

    def _look(self) -> None:
        """On the timer's thread."""
        charge = self._senses.battery() if self._senses.battery else None
        waiting = [kept for kept in self._store.all if _percent(kept) is not None]
        low = [kept for kept in waiting if charge is not None and _is_below(charge, kept)]
        with self._lock:
            self._looks = len(waiting) > len(low)
            if self._looks:
                self._timer.set(LOOK_EVERY_S, self._look)
        for kept in low:
            self._met(kept)


def _percent(kept: Kept) -> float | None:
    match kept.program:
        case When(condition=BatteryBelow(percent=percent)):
            return percent
    return None


def _is_below(charge: float, kept: Kept) -> bool:
    percent = _percent(kept)
    return percent is not None and 100 * charge < percent
