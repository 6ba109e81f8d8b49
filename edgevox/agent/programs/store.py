"""The store of programs, their bounds, and their waits.

- `Kept`: a kept program with its rest, its due time and its progress.
- `check_bounds`: refuses a program that is too large, with a reason.
- `ProgramStore`: holds each program from one put to one take, and publishes its changes.
- `Waits`: waits for a state of the robot, such as a low battery, or for the end of a goal.
"""

import threading
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from edgevox.agent.goals.executor import MAX_CALLS
from edgevox.agent.goals.goal import Goal
from edgevox.agent.known import Known
from edgevox.agent.nlu.meaning import (
    After,
    Again,
    BatteryBelow,
    Pause,
    Program,
    Repeat,
    Return,
    StateIs,
    When,
    calls_of,
    parts_of,
)
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.skills.skill import no_way_back
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import GOAL_ENDS, GoalStatus, ProgramChanged, ProgramStatus
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.commands import Way
from edgevox.core.reason import Reason


def _nothing() -> None:
    """Call off nothing: the program has no timer."""


@dataclass(eq=False, slots=True)
class Kept:
    """A program from its order to its end. Only `Programs` and the store change it."""

    id: str
    """The program's id."""
    program: Program
    """The rest of the program: without its delay, once that is over."""
    turn: int
    """Number of the turn that asked for it."""
    way: Way
    """The way in which it was asked for."""
    mark: int
    """The interlock's mark when it was asked for."""
    confirmed: bool = False
    """True if a person said yes to it."""
    due_s: float | None = None
    """The clock's time when it goes on by itself; None if it waits for no time."""
    round: int | None = None
    """Number of times that its steps were begun; None if it does not repeat them."""
    goal: Goal | None = None
    """The goal that runs its steps; None while it waits."""
    call_off: Callable[[], None] = field(default=_nothing)
    """Calls off its timer."""

    @property
    def status(self) -> ProgramStatus:
        """`WAITING`, or `RUNNING` once it has a goal."""
        return ProgramStatus.RUNNING if self.goal else ProgramStatus.WAITING


MAX_PROGRAMS = 8
"""Number of programs that may wait and run at a time."""
MAX_TIMES = 100
"""Number of times that a program may repeat its steps, unless it repeats them until a stop."""
LONGEST_WAIT_S = 24 * 3600.0
"""Longest wait of a program for its time or its condition, in seconds."""
LONGEST_RUN_S = 8 * 3600.0
"""Longest run of a program, in seconds."""


def check_bounds(program: Program, known: Known, skills: Collection[Skill]) -> None:
    """Raise `SkillFailed` with the reason for a program that is too large or impossible.

    `skills` are all skills of the robot.
    """
    if len(calls_of(program)) > MAX_CALLS:
        raise SkillFailed(because("program_long", count=str(MAX_CALLS)))
    parts = [*parts_of(program)]
    delays_s = [one.delay_s for one in parts if isinstance(one, After)]
    delays_s += [one.seconds for one in parts if isinstance(one, Pause)]
    if sum(delays_s) > LONGEST_WAIT_S:
        raise SkillFailed(because("program_late", hours=f"{LONGEST_WAIT_S / 3600:g}"))
    for one in parts_of(program):
        _check_part(one, known, skills)


def _check_part(part: Program, known: Known, skills: Collection[Skill]) -> None:
    match part:
        case Repeat(count=float() | int() as count) if not (
            count == int(count) and 1 <= count <= MAX_TIMES
        ):
            raise SkillFailed(because("program_times", said=f"{count:g}", count=str(MAX_TIMES)))
        case When(condition=BatteryBelow()) if known.battery is None or known.battery() is None:
            raise SkillFailed(because("no_battery"))
        case When(condition=BatteryBelow(percent=percent)) if not 0 < percent < 100:
            raise SkillFailed(because("program_percent", said=f"{percent:g}"))
        case Return() if known.way_back() is None:
            raise SkillFailed(no_way_back(skills))
        case Again():
            raise SkillFailed(because("nothing_before"))


_TENTHS = 1


class Timer(Protocol):
    """Runs actions later, on one thread that otherwise sleeps: `Deadlines` is one."""

    def start(self) -> None: ...

    def close(self) -> None: ...

    def set(self, seconds: float, action: Callable[[], None]) -> Callable[[], None]:
        """Run `action` after `seconds`. Returns a function that calls it off."""


class ProgramStore:
    """The programs that wait and run, in the order of their requests. Any thread may ask.

    `describe` returns a program in words.
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
        """All programs that wait and run."""
        with self._lock:
            return tuple(self._kept.values())

    def has(self, kept: Kept) -> bool:
        """True until the program is taken."""
        with self._lock:
            return kept.id in self._kept

    def put(self, kept: Kept, asked: CancelToken) -> bool:
        """Keep a program; False if its turn was stopped. Raises `SkillFailed` if there is no room.

        `asked` is the token of the turn that asked for it.
        """
        with self._lock:
            if asked.cancelled:
                return False
            if len(self._kept) >= MAX_PROGRAMS:
                raise SkillFailed(because("programs_full", count=str(MAX_PROGRAMS)))
            self._kept[kept.id] = kept
            return True

    def take(self, kept: Kept) -> bool:
        """Remove a program and call off its timer; False if it was taken before."""
        with self._lock:
            taken = self._kept.pop(kept.id, None) is not None
            if taken:
                kept.call_off()
            return taken

    def later(self, kept: Kept, seconds: float, action: Callable[[], None]) -> None:
        """Run `action` after `seconds` in place of the program's other timer, if it is kept."""
        with self._lock:
            if kept.id in self._kept:
                kept.call_off()
                kept.call_off = self._timer.set(seconds, action)

    def text(self, kept: Kept) -> str:
        """The rest of a program, described for a person."""
        left = kept.program
        if isinstance(left, After) and kept.due_s is not None:
            left = After(max(0.0, kept.due_s - self._clock.now()), left.program)
        return self._describe(left)

    def event(
        self, kept: Kept, status: ProgramStatus | None = None, reason: Reason | None = None
    ) -> ProgramChanged:
        """The program's state as an event."""
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
        """Publish the program's state, or its `end`, after which nothing more is published."""
        with self._telling:
            if end is not None or self.has(kept):
                self._bus.publish(self.event(kept, end, reason))


LOOK_EVERY_S = 0.5
"""Seconds between two looks at the robot's state while a program waits for it."""


class Waits:
    """Calls `met` once for each program whose condition came true, `missed` if it cannot."""

    def __init__(
        self,
        store: ProgramStore,
        timer: Timer,
        known: Known,
        met: Callable[[Kept], None],
        missed: Callable[[Kept], None],
    ) -> None:
        self._store = store
        self._timer = timer
        self._known = known
        self._met = met
        self._missed = missed
        self._lock = threading.Lock()
        self._looks = False
        self._goals: dict[str, tuple[Goal, Kept]] = {}

    def for_state(self) -> None:
        """Look at the robot's state now, and repeat that while a program waits for it."""
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
        """Tell that a goal has ended and its end was said."""
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
        """Look at the state once, on the timer's thread."""
        waiting = [kept for kept in self._store.all if _state_of(kept) is not None]
        met = [kept for kept in waiting if self._is_so(_state_of(kept))]
        with self._lock:
            self._looks = len(waiting) > len(met)
            if self._looks:
                self._timer.set(LOOK_EVERY_S, self._look)
        for kept in met:
            self._met(kept)

    def _is_so(self, condition: BatteryBelow | StateIs | None) -> bool:
        match condition:
            case BatteryBelow(percent=percent):
                charge = self._known.battery() if self._known.battery else None
                return charge is not None and 100 * charge < percent
            case StateIs(name=name, value=value):
                return self._known.conditions[name].is_so(value)
        return False


def _state_of(kept: Kept) -> BatteryBelow | StateIs | None:
    """The state that a program waits for; None if it waits for none."""
    match kept.program:
        case When(condition=BatteryBelow() | StateIs() as condition):
            return condition
    return None
