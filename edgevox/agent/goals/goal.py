"""The goal: one call of one skill, with its arguments, progress and end."""

import json
import threading
import uuid
from collections.abc import Mapping
from typing import Any, Protocol

from edgevox.agent.skills import Skill, SkillFailed, reason_of
from edgevox.agent.skills.failures import WrongArgument
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import GOAL_ENDS, GoalCancelled, GoalChanged, GoalStatus
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import shorten
from edgevox.core.log import bound, get_logger
from edgevox.core.reason import NO_REASON, Reason

log = get_logger(__name__)


_MOST_REASON = 200


class GoalLeave(Protocol):
    """Permission for a goal. Both methods raise `SkillFailed` with the reason of a refusal."""

    def begin(self) -> None:
        """Permit the goal to begin. Called once, on the thread that runs it."""

    def go_on(self) -> None:
        """Permit the goal to go on. Called whenever it reports progress."""


class _AnyLeave:
    """Permits everything, for a goal whose maker has judged it."""

    def begin(self) -> None:
        """It may."""

    def go_on(self) -> None:
        """It may."""


_MAY = _AnyLeave()


class Goal:
    """The `GoalHandle` that the skill's function gets. Only the code that runs it changes it.

    `turn` is 0 for a goal that no words asked for. `leave` permits the goal to begin and to go on.
    """

    def __init__(
        self,
        skill: Skill,
        arguments: Mapping[str, Any],
        *,
        turn: int,
        bus: Bus,
        goal_id: str | None = None,
        leave: GoalLeave = _MAY,
    ) -> None:
        self.id = goal_id or uuid.uuid4().hex
        self.skill = skill
        self.arguments = dict(arguments)
        self.turn = turn
        self.status = GoalStatus.ACCEPTED
        self.feedback: Mapping[str, Any] = {}
        self.result: Mapping[str, Any] = {}
        self.reason = NO_REASON
        self.replaces: Goal | None = None
        """The goal that had to end for this one."""
        self._bus = bus
        self._leave = leave
        self._forbidden = NO_REASON
        self._token = CancelToken()
        self._ending = threading.Lock()
        self._ended = threading.Event()

    @property
    def error(self) -> str:
        """The reason why the goal did not succeed, in English; empty if it did or still runs."""
        return str(self.reason)

    @property
    def ended_another(self) -> bool:
        """True if another goal was cancelled for this one."""
        return self.replaces is not None and self.replaces.status is GoalStatus.CANCELLED

    @property
    def token(self) -> CancelToken:
        return self._token

    def report(self, **feedback: Any) -> None:
        """Publish progress. Raises `TypeError` or `ValueError` for values that are not JSON."""
        json.dumps(feedback)
        self.feedback = feedback
        if self.status is GoalStatus.RUNNING:
            self._tell(feedback=feedback)
            self._ask()

    def _ask(self) -> None:
        """Cancel the goal if it may not go on, so that the body halts at once."""
        try:
            self._leave.go_on()
        except SkillFailed as error:
            self._forbidden = error.reason
            self._token.cancel(error.reason)

    def wait(self, timeout_s: float | None = None) -> bool:
        """Block until the goal has ended; False if it had not within the timeout."""
        return self._ended.wait(timeout_s)

    def accept(self) -> None:
        """Publish that this goal will run."""
        self._tell()

    def run(self) -> None:
        """Run the skill on the calling thread, to one of the ends. Never raises."""
        with bound(goal=self.id, turn=self.turn):
            if self._begins():
                self._call()
            else:
                self.end(GoalStatus.CANCELLED, self._token.why)

    def _begins(self) -> bool:
        """Publish that the goal runs; False if it has ended or is cancelled, before or after."""
        if self._token.cancelled:
            return False
        with self._ending:
            if self.status in GOAL_ENDS:
                return False
            self.status = GoalStatus.RUNNING
        self._tell()
        return not self._token.cancelled and self.status is GoalStatus.RUNNING

    def _call(self) -> None:
        try:
            self._leave.begin()
            result = _as_json(self.skill.function(self, **self.arguments))
        except Cancelled as cancelled:
            if self._forbidden and self._token.why == self._forbidden:
                self.end(GoalStatus.FAILED, self._forbidden)
            else:
                self.end(GoalStatus.CANCELLED, self._token.why or cancelled.why)
        except (SkillFailed, WrongArgument) as error:  # reasons that may be said aloud
            self.end(GoalStatus.FAILED, reason_of(error))
        except BaseException as error:
            log.exception("skill_broke", skill=self.skill.name)
            said = " ".join(str(error).split())[:_MOST_REASON] or type(error).__name__
            self.end(GoalStatus.FAILED, because("skill_broke", skill=self.skill.name, why=said))
        else:
            self.end(GoalStatus.SUCCEEDED, result=result)

    def drop(self, reason: Reason) -> None:
        """End the goal without running it."""
        self._token.cancel(reason)
        self.end(GoalStatus.CANCELLED, reason)

    def end(
        self,
        status: GoalStatus,
        reason: Reason = NO_REASON,
        *,
        result: Mapping[str, Any] = {},
    ) -> None:
        """End the goal and publish that; only the first end counts.

        A cancellation without a code gets the code `called_off`.
        """
        if status is GoalStatus.CANCELLED and not reason.code:
            reason = because("called_off", reason.text)
        with self._ending:
            if self.status in GOAL_ENDS:
                return
            self.result, self.reason = dict(result), reason
            self.status = status
        if status is GoalStatus.CANCELLED:
            told = GoalCancelled(self.id, self.skill.name, self.arguments, self.turn, reason)
            self._bus.publish(told)
        elif status is GoalStatus.FAILED:
            self._tell(reason=reason)
        else:
            self._tell(result=self.result)
        self._ended.set()

    def _tell(
        self,
        feedback: Mapping[str, Any] | None = None,
        result: Mapping[str, Any] | None = None,
        reason: Reason | None = None,
    ) -> None:
        """Publish the goal's status."""
        what = (self.id, self.skill.name, self.arguments, self.status, self.turn)
        self._bus.publish(GoalChanged(*what, feedback, result, reason))


def _as_json(result: Any) -> Mapping[str, Any]:
    """The skill's result. Raises `TypeError` if it is no JSON object."""
    if result is None:
        return {}
    if not isinstance(result, Mapping):
        raise TypeError(f"its result is {shorten(result)}, not a mapping")
    try:
        json.dumps(result)
    except (TypeError, ValueError) as error:
        raise TypeError(f"its result is not JSON: {error}") from None
    return result
