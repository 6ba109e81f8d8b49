"""Lanes, which run plans of goals one after another and leave a thread behind if a skill hangs."""

import threading
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from edgevox.agent.goals.goal import Goal
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import GOAL_ENDS, GoalStatus
from edgevox.core.log import bound, get_logger
from edgevox.core.motion.deadlines import Deadlines
from edgevox.core.reason import Reason

log = get_logger(__name__)

GRACE_S = 2.0
"""Seconds that a cancelled skill has to return; then its goal ends without it."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Goals that run one after another."""

    goals: Sequence[Goal]
    """The goals, in their order."""
    limit_s: float | None = None
    """Longest time for each goal, in seconds; None for no limit."""


_NOTHING = Plan(())


class Lane:
    """Runs plans in their order (`append`), or the newest in place of all others (`replace`).

    A goal that does not succeed ends the rest of its plan as cancelled. `on_end` is called for
    every goal that ran, after its end was published. A skill that does not return within `GRACE_S`
    of its cancellation, or within its plan's limit, stays alone on its thread: its goal ends, and
    the lane goes on with another thread. The owner starts and closes `deadlines`.
    """

    def __init__(
        self, name: str, deadlines: Deadlines, on_end: Callable[[Goal], None] = lambda _: None
    ) -> None:
        self._name = name
        self._deadlines = deadlines
        self._on_end = on_end
        self._wake = threading.Condition()
        self._waiting: deque[Plan] = deque()
        self._current = _NOTHING
        self._running: Goal | None = None
        self._closed = False
        self._worker = self._new_worker()

    def start(self) -> None:
        self._worker.start()

    def close(self) -> None:
        """Cancel all goals and wait for the thread, unless it hangs in a skill."""
        with self._wake:
            self._closed = True
            self._wake.notify_all()
        self.cancel(because("shutting_down"))
        if self._worker.is_alive():
            self.wait_idle()
            self._worker.join(GRACE_S)

    @property
    def busy(self) -> bool:
        """True if any goal runs or waits."""
        with self._wake:
            return self._has_work()

    @property
    def waiting(self) -> int:
        """Number of waiting plans."""
        with self._wake:
            return len(self._waiting)

    @property
    def last(self) -> Goal | None:
        """The last goal of all plans that run or wait, or None."""
        with self._wake:
            plans = [plan.goals for plan in (self._current, *self._waiting) if plan.goals]
            return plans[-1][-1] if plans else None

    def append(self, plan: Plan) -> None:
        """Run this plan after the waiting ones."""
        self._submit(plan, replace=False)

    def replace(self, plan: Plan) -> None:
        """Run this plan in place of all that run or wait."""
        running, superseded = self._submit(plan, replace=True)
        newer = plan.goals[0].skill.name if plan.goals else "nothing"
        _cancel(running, superseded, because("preempted", skill=newer))

    def cancel(self, reason: Reason | str) -> bool:
        """Cancel all plans without waiting for their ends; True if there was any."""
        with self._wake:
            running, waiting = self._take_all()
        _cancel(running, waiting, reason if isinstance(reason, Reason) else Reason(reason))
        return bool(running.goals or waiting)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until no plan runs or waits; False after the timeout."""
        with self._wake:
            return self._wake.wait_for(lambda: not self._has_work(), timeout_s)

    def _has_work(self) -> bool:
        return bool(self._current.goals or self._waiting)

    def _submit(self, plan: Plan, *, replace: bool) -> tuple[Plan, Sequence[Plan]]:
        """Queue a plan; return the running plan and the waiting ones that it replaces."""
        for goal in plan.goals:
            goal.accept()
        with self._wake:
            closed = self._closed
            running, superseded = self._take_all() if replace else (_NOTHING, ())
            if not closed:
                self._waiting.append(plan)
            self._wake.notify_all()
        if closed:
            _drop(plan.goals, because("shutting_down"))
        return running, superseded

    def _take_all(self) -> tuple[Plan, Sequence[Plan]]:
        waiting = tuple(self._waiting)
        self._waiting.clear()
        self._wake.notify_all()
        return self._current, waiting

    def _new_worker(self) -> threading.Thread:
        # A daemon: nothing can end a thread that never returns, and it must not keep the process.
        return threading.Thread(target=self._work, name=f"edgevox-goals-{self._name}", daemon=True)

    def _work(self) -> None:
        while plan := self._next():
            self._run(plan)

    def _next(self) -> Plan | None:
        """Wait for the next plan of this thread; None if the thread must end."""
        me = threading.current_thread()
        with self._wake:
            self._wake.wait_for(lambda: self._may_begin() or self._closed or self._worker is not me)
            if self._closed or self._worker is not me:
                return None
            self._current = self._waiting.popleft()
            return self._current

    def _may_begin(self) -> bool:
        return bool(self._waiting) and not self._current.goals

    def _run(self, plan: Plan) -> None:
        for goal in plan.goals:
            if not self._ran_in_time(goal, plan):
                return
            if self._told(goal) is not GoalStatus.SUCCEEDED:
                break
        self._finish(plan)

    def _ran_in_time(self, goal: Goal, plan: Plan) -> bool:
        """Run a goal under deadlines; False if the lane gave up on it and its plan."""
        leave = partial(self._leave, goal, plan)
        with self._wake:
            self._running = goal
        forgets: list[Callable[[], None]] = []
        forgets.append(
            goal.token.on_cancel(lambda: forgets.append(self._deadlines.set(GRACE_S, leave)))
        )
        if plan.limit_s is not None:
            forgets.append(self._deadlines.set(plan.limit_s, leave))
        goal.run()
        with self._wake:
            mine = self._running is goal
            self._running = None if mine else self._running
        for forget in forgets:
            forget()
        return mine

    def _leave(self, goal: Goal, plan: Plan) -> None:
        """End a goal whose skill does not return, and go on with another thread."""
        with self._wake:
            if self._running is not goal:
                return
            self._running = None
            self._replace_worker(goal)
        with bound(goal=goal.id, turn=goal.turn):
            log.error("skill_does_not_end", skill=goal.skill.name)
        if goal.token.cancelled:
            goal.end(GoalStatus.CANCELLED, goal.token.why)
        else:
            limit = f"{plan.limit_s:.0f}"
            late = because("took_too_long", skill=goal.skill.name, seconds=limit)
            goal.end(GoalStatus.FAILED, late)
            goal.token.cancel("it took too long")
        self._told(goal)
        self._finish(plan)

    def _replace_worker(self, goal: Goal) -> None:
        """Give the lane another thread; if none can start, the lane waits for the hanging one."""
        left, self._worker = self._worker, self._new_worker()
        try:
            self._worker.start()
        except RuntimeError as error:  # the machine gives no more threads
            log.error("no_thread_left", skill=goal.skill.name, reason=str(error))  # noqa: TRY400
            self._worker = left

    def _told(self, goal: Goal) -> GoalStatus:
        """Call `on_end`, and return the goal's status."""
        try:
            self._on_end(goal)
        except Exception:
            log.exception("goal_end_untold", skill=goal.skill.name, goal=goal.id)
        return goal.status

    def _finish(self, plan: Plan) -> None:
        """End the plan; its goals that did not run end as cancelled."""
        ran = [goal for goal in plan.goals if goal.status in GOAL_ENDS]
        if ran:
            last = ran[-1]
            why = because("step_ended", skill=last.skill.name, status=str(last.status))
            _drop(plan.goals[len(ran) :], why)
        with self._wake:
            self._current = _NOTHING
            self._wake.notify_all()


def _cancel(running: Plan, waiting: Sequence[Plan], reason: Reason) -> None:
    for goal in running.goals:
        goal.token.cancel(reason)
    for plan in waiting:
        _drop(plan.goals, reason)


def _drop(goals: Sequence[Goal], reason: Reason) -> None:
    for goal in goals:
        goal.drop(reason)
