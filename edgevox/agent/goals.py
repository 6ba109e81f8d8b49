"""Goals: skills that run beside the conversation, one plan at a time."""

import contextvars
import json
import threading
import uuid
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from typing import Any

from edgevox.agent.skills import Skill
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import EdgeVoxError, shorten
from edgevox.core.events import AgentEvent, AgentEventKind
from edgevox.core.log import bound, get_logger

log = get_logger(__name__)


class Status(StrEnum):
    """Where a goal is in its life; the last three are its ends."""

    ACCEPTED = "accepted"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


ENDS = frozenset({Status.SUCCEEDED, Status.FAILED, Status.CANCELLED})
GRACE_S = 2.0
"""A skill that was cancelled has this long to return; then its goal ends without it."""
_MOST_REASON = 200


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
        self._ending = threading.Lock()
        self._ended = threading.Event()

    @property
    def token(self) -> CancelToken:
        return self._token

    def report(self, **feedback: Any) -> None:
        """Publish how far this goal is. Raises `TypeError` or `ValueError` for what is not JSON."""
        json.dumps(feedback)
        self.feedback = feedback
        if self.status is Status.RUNNING:
            self._publish(AgentEventKind.SKILL_GOAL, feedback=feedback)

    def wait(self, timeout_s: float | None = None) -> bool:
        """Block until the goal has ended; False if it had not within the timeout."""
        return self._ended.wait(timeout_s)

    def accept(self) -> None:
        """Say on the bus that this goal will run."""
        self._publish(AgentEventKind.SKILL_GOAL)

    def run(self, limit_s: float | None = None) -> None:
        """Run the skill and block until one of the ends. Never raises.

        The skill gets a thread of its own. It is left alone on it, and the goal ends, if it does
        not return `GRACE_S` after it was cancelled, or within `limit_s`.
        """
        with bound(goal=self.id, turn=self.turn):
            self._run(limit_s)

    def _run(self, limit_s: float | None) -> None:
        if self._token.cancelled:
            self._end(Status.CANCELLED, error=self._token.reason)
            return
        self.status = Status.RUNNING
        self._publish(AgentEventKind.SKILL_GOAL)
        over = threading.Event()  # it has returned, or it should
        forget = self._token.on_cancel(over.set)
        context = contextvars.copy_context()
        # A daemon: nothing can end a thread that never returns, and it must not keep the process.
        worker = threading.Thread(
            target=lambda: context.run(self._work, over),
            name=f"edgevox-skill-{self.skill.name}",
            daemon=True,
        )
        try:
            worker.start()
        except RuntimeError as error:  # the machine gives no more threads
            self._end(Status.FAILED, error=f"{self.skill.name} could not begin: {error}")
        in_time = self._ended.is_set() or over.wait(limit_s)
        forget()
        if in_time and (self._ended.is_set() or self._ended.wait(GRACE_S)):
            return
        log.error("skill_does_not_end", skill=self.skill.name)
        if in_time:
            self._end(Status.CANCELLED, error=self._token.reason)
        else:
            self._end(Status.FAILED, error=f"{self.skill.name} took longer than {limit_s:.0f} s")
            self._token.cancel("it took too long")

    def _work(self, over: threading.Event) -> None:
        """Run the skill on the calling thread, to one of the ends."""
        try:
            result = _as_json(self.skill.function(self, **self.arguments))
        except Cancelled as cancelled:
            self._end(Status.CANCELLED, error=self._token.reason or str(cancelled))
        except EdgeVoxError as error:  # `SkillFailed`, or what it called did
            self._end(Status.FAILED, error=str(error))
        except BaseException as error:
            log.exception("skill_broke", skill=self.skill.name)
            said = " ".join(str(error).split())[:_MOST_REASON] or type(error).__name__
            self._end(Status.FAILED, error=f"{self.skill.name} broke: {said}")
        else:
            self._end(Status.SUCCEEDED, result=result)
        finally:
            over.set()

    def drop(self, reason: str) -> None:
        """End it without ever having run."""
        self._token.cancel(reason)
        self._end(Status.CANCELLED, error=reason)

    def _end(self, status: Status, *, result: Mapping[str, Any] = {}, error: str = "") -> None:
        """It is over; only the first end counts."""
        with self._ending:
            if self.status in ENDS:
                return
            self.result, self.error = dict(result), error
            self.status = status
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
            try:
                self._on_end(goal)
            except Exception:
                log.exception("goal_end_untold", skill=goal.skill.name, goal=goal.id)
            if goal.status is not Status.SUCCEEDED:
                _drop(plan[position + 1 :], f"{goal.skill.name} {goal.status}")
                return


def _as_json(result: Any) -> Mapping[str, Any]:
    """What a skill returned. Raises `TypeError` or `ValueError` if it is no JSON object."""
    if result is None:
        return {}
    if not isinstance(result, Mapping):
        raise TypeError(f"its result is {shorten(result)}, not a mapping")
    try:
        json.dumps(result)
    except (TypeError, ValueError) as error:
        raise TypeError(f"its result is not JSON: {error}") from None
    return result


def _cancel(goals: Sequence[Goal], reason: str) -> None:
    for goal in goals:
        goal.token.cancel(reason)


def _drop(goals: Sequence[Goal], reason: str) -> None:
    for goal in goals:
        if goal.status not in ENDS:
            goal.drop(reason)
