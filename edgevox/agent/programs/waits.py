"""What programs wait for besides time: a battery that gets low, a goal that ends."""

import threading
from collections.abc import Callable

from edgevox.agent.goals import Goal
from edgevox.agent.programs.kept import Kept
from edgevox.agent.programs.program import BatteryBelow, When
from edgevox.agent.programs.program_store import ProgramStore, Timer
from edgevox.agent.programs.senses import Senses
from edgevox.core.agent_events import GOAL_ENDS, GoalStatus

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
