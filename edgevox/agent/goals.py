"""Goals: skills that run beside the conversation, one plan at a time."""

import logging
import threading
import uuid
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from typing import Any

from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import AgentEvent, AgentEventKind

log = logging.getLogger(__name__)


class Status(StrEnum):
    """Where a goal is in its life; the last three are its ends."""

    ACCEPTED = "accepted"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


ENDS = frozenset({Status.SUCCEEDED, Status.FAILED, Status.CANCELLED})


class Goal:
    """One call of one skill: what was asked, how far it is, how it ended.

    It is the `GoalHandle` that the skill's function sees. Only its runner changes it. `turn` is 0
    for a goal that nobody asked for in words.
    """

    def __init__(
        self,
        skill: Skill,
        arguments: Mapping[str, Any],
        *,
        turn: int,
        bus: Bus,
        goal_id: str | None = None,
    ) -> None:
        self.id = goal_id or uuid.uuid4().hex
        self.skill = skill
        self.arguments = dict(arguments)
        self.turn = turn
        self.status = Status.ACCEPTED
        self.feedback: Mapping[str, Any] = {}
        self.result: Mapping[str, Any] = {}
        self.error = ""
        self._bus = bus
        self._token = CancelToken()
        self._ended = threading.Event()

    @property
    def token(self) -> CancelToken:
        return self._token

    def report(self, **feedback: Any) -> None:
        """Publish how far this goal is."""
        self.feedback = feedback
        if self.status is Status.RUNNING:
            self._publish(AgentEventKind.SKILL_GOAL, feedback=feedback)

    def wait(self, timeout_s: float | None = None) -> bool:
        """Block until the goal has ended; False if it had not within the timeout."""
        return self._ended.wait(timeout_s)

    def accept(self) -> None:
        """Say on the bus that this goal will run."""
        self._publish(AgentEventKind.SKILL_GOAL)

    def run(self) -> None:
        """Run the skill on the calling thread, to one of the ends. Never raises."""
        if self._token.cancelled:
            self._end(Status.CANCELLED, error=self._token.reason)
            return
        self.status = Status.RUNNING
        self._publish(AgentEventKind.SKILL_GOAL)
        try:
            result = self.skill.function(self, **self.arguments) or {}
        except Cancelled as cancelled:
            self._end(Status.CANCELLED, error=self._token.reason or str(cancelled))
        except SkillFailed as failure:
            self._end(Status.FAILED, error=str(failure))
        except EdgeVoxError as error:
            self._end(Status.FAILED, error=str(error))
        except Exception as error:
            log.exception("skill %s failed", self.skill.name)
            self._end(Status.FAILED, error=f"{self.skill.name} broke: {error}")
        else:
            self._end(Status.SUCCEEDED, result=result)

    def drop(self, reason: str) -> None:
        """End it without ever having run."""
        self._token.cancel(reason)
        self._end(Status.CANCELLED, error=reason)

    def _end(self, status: Status, *, result: Mapping[str, Any] = {}, error: str = "") -> None:
        self.status = status
        self.result = dict(result)
        self.error = error
        if status is Status.CANCELLED:
            self._publish(AgentEventKind.SKILL_CANCELLED, reason=error)
        elif status is Status.FAILED:
            self._publish(AgentEventKind.SKILL_GOAL, error=error)
        else:
            self._publish(AgentEventKind.SKILL_GOAL, result=self.result)
        self._ended.set()

    def _publish(self, kind: AgentEventKind, **more: Any) -> None:
        data = {
            "goal_id": self.id,
            "skill": self.skill.name,
            "arguments": self.arguments,
            "status": str(self.status),
            "turn": self.turn,
        }
        self._bus.publish(AgentEvent(kind, {**data, **more}))


class GoalRunner:
    """Runs plans of goals on one thread of its own; a new plan pre-empts the one that runs.

    The goals of a plan run in order. One that does not succeed stops the rest, which end as
    cancelled. `on_end` is called on the runner's thread for every goal that ran, after its end was
    published.
    """

    def __init__(self, on_end: Callable[[Goal], None]) -> None:
        self._on_end = on_end
        self._wake = threading.Condition()
        self._current: list[Goal] = []
        self._next: list[Goal] = []
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="edgevox-goals")

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

    def submit(self, plan: Sequence[Goal]) -> None:
        """Run these goals instead of whatever runs or waits."""
        for goal in plan:
            goal.accept()
        with self._wake:
            closed = self._closed
            superseded, self._next = self._next, [] if closed else list(plan)
            running = list(self._current)
            self._wake.notify_all()
        if closed:
            _drop(plan, "shutting down")
        reason = f"pre-empted by {plan[0].skill.name}" if plan else "pre-empted"
        _cancel(running, reason)
        _drop(superseded, reason)

    def cancel(self, reason: str) -> bool:
        """Cancel what runs and waits; True if anything did. Does not wait for its end."""
        with self._wake:
            waiting, self._next = self._next, []
            running = list(self._current)
        _cancel(running, reason)
        _drop(waiting, reason)
        return bool(running or waiting)

    @property
    def busy(self) -> bool:
        """Whether any goal runs or waits."""
        with self._wake:
            return bool(self._current or self._next)

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until nothing runs or waits; False if something still did after the timeout."""
        with self._wake:
            return self._wake.wait_for(lambda: not (self._current or self._next), timeout_s)

    def _work(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._next or self._closed)
                if self._closed:
                    return
                self._current, self._next = self._next, []
            self._run(self._current)
            with self._wake:
                self._current = []
                self._wake.notify_all()

    def _run(self, plan: Sequence[Goal]) -> None:
        for position, goal in enumerate(plan):
            goal.run()
            self._on_end(goal)
            if goal.status is not Status.SUCCEEDED:
                _drop(plan[position + 1 :], f"{goal.skill.name} {goal.status}")
                return


def _cancel(goals: Sequence[Goal], reason: str) -> None:
    for goal in goals:
        goal.token.cancel(reason)


def _drop(goals: Sequence[Goal], reason: str) -> None:
    for goal in goals:
        if goal.status not in ENDS:
            goal.drop(reason)
