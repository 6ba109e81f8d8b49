"""Steps on a node: what publishes, calls, runs actions, reads and waits."""

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.ros2.qos import interface_profile
from edgevox.ros2.robot_file.field_paths import read_path
from edgevox.ros2.robot_file.filling import Filling
from edgevox.ros2.robot_file.interface_reasons import interface_reason
from edgevox.ros2.robot_file.outcome import holds, values_of
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.step_format import ActionInterface, Publication, Topic, Wait
from edgevox.ros2.robot_file.waiting import Newest, TookTooLong, wait_for, wait_until

log = get_logger(__name__)

THERE_S = 3.0
"""So long an interface may take to be discovered."""
READ_S = 5.0
"""What was heard so long ago is no answer; unless the topic is latched, which says it once."""
CANCEL_S = 5.0
"""So long an action that is cancelled may take to end."""

Report = Callable[..., None]


@dataclass(frozen=True, slots=True)
class StepRun:
    """One time that a step is done: the values for its request, and the goal it is done for.

    `asked_s` is when the step before it began to ask for something, if there is one. `stop` does
    what the skill does when it ends early; only the first call counts.
    """

    values: Mapping[str, Any]
    token: CancelToken
    report: Report
    asked_s: float | None = None
    stop: Callable[[], None] = lambda: None


class LiveStep(Protocol):
    """A step that can be done. `run` blocks, on a thread that is not the node's."""

    def run(self, run: StepRun) -> dict[str, Any]:
        """Its results. Raises `SkillFailed` with the reason, or `Cancelled`."""


def go_live(planned: PlannedStep, node: Node, clock: Clock) -> LiveStep:
    """A step on this node, which is not yet spun, or on the thread that spins it."""
    return _KINDS[planned.way](planned, node, clock)


class _Base:
    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        self._planned, self._step, self._node, self._clock = planned, planned.step, node, clock
        self._name = planned.interface_name
        self._filling = Filling(lambda: node.get_clock().now().to_msg())

    def _request(self, run: StepRun) -> Any:
        return self._filling.fill(self._planned.request(), self._step.request, run.values)

    def _failed(self, code: str) -> SkillFailed:
        log.warning("interface_failed", interface=self._name, why=code)
        return SkillFailed(interface_reason(code, what=self._name))

    def _until_there(self, look: Callable[[], bool], run: StepRun, code: str) -> None:
        try:
            wait_until(look, run.token, min(THERE_S, self._step.timeout_s), self._clock)
        except TookTooLong:
            raise self._failed(code) from None


class Publishes(_Base):
    """Publishes once, or at a rate until its time is over or it is stopped."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        self._how: Publication = getattr(self._step, planned.way)
        qos = interface_profile(latched=self._how.latched, heard=False)
        self._publisher = node.create_publisher(planned.type, self._name, qos)

    def run(self, run: StepRun) -> dict[str, Any]:
        message = self._request(run)
        if not self._how.latched:
            heard = self._publisher.get_subscription_count
            self._until_there(lambda: heard() > 0, run, "nobody_listens")
        try:
            self._repeat(message, run)
        finally:
            if self._how.at_end is not None:
                end = self._filling.fill(self._planned.request(), self._how.at_end, run.values)
                self._publisher.publish(end)
        return {}

    def _repeat(self, message: Any, run: StepRun) -> None:
        run.token.check()
        self._publisher.publish(message)
        begun_s = self._clock.now()
        while self._how.rate_hz:
            passed_s = self._clock.now() - begun_s
            if self._how.for_s and passed_s >= self._how.for_s:
                return
            if run.token.wait(1.0 / self._how.rate_hz):
                run.token.check()
            self._publisher.publish(message)
            if self._how.for_s:
                run.report(progress=round(min(1.0, passed_s / self._how.for_s), 3))


class Calls(_Base):
    """Calls a service."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        self._client = node.create_client(planned.type, self._name)

    def run(self, run: StepRun) -> dict[str, Any]:
        self._until_there(self._client.service_is_ready, run, "not_there")
        future = self._client.call_async(self._request(run))
        try:
            answer = wait_for(future, run.token, self._step.timeout_s)
        except (TookTooLong, Cancelled) as end:
            self._client.remove_pending_request(future)
            if isinstance(end, Cancelled):
                raise
            run.stop()  # it may still be at it
            raise self._failed("no_answer") from None
        return values_of(self._planned, answer, run.values)


class Acts(_Base):
    """Runs an action; a stop cancels it and waits until it has ended."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        how: ActionInterface = getattr(self._step, planned.way)
        self._progress = how.progress
        self._client = ActionClient(node, planned.type, self._name)

    def run(self, run: StepRun) -> dict[str, Any]:
        self._until_there(self._client.server_is_ready, run, "not_there")
        until_s = self._clock.now() + self._step.timeout_s
        sent = self._client.send_goal_async(
            self._request(run), feedback_callback=lambda message: self._hear(message, run)
        )
        try:
            handle = wait_for(sent, run.token, self._step.timeout_s)
        except (TookTooLong, Cancelled) as end:
            sent.add_done_callback(_cancel_late)
            raise end if isinstance(end, Cancelled) else self._failed("no_answer") from None
        if not handle.accepted:
            raise self._failed("refused")
        ended = handle.get_result_async()
        try:
            answer = wait_for(ended, run.token, max(0.0, until_s - self._clock.now()))
        except (TookTooLong, Cancelled) as end:
            self._cancel(handle, ended, run)
            raise end if isinstance(end, Cancelled) else self._failed("no_answer") from None
        if answer.status != GoalStatus.STATUS_SUCCEEDED:
            raise self._failed("gave_up")
        return values_of(self._planned, answer.result, run.values)

    def _hear(self, message: Any, run: StepRun) -> None:
        if self._progress is None or run.token.cancelled:
            return
        part = read_path(message.feedback, self._progress)
        if isinstance(part, int | float) and 0.0 <= part <= 1.0:
            run.report(progress=round(float(part), 3))

    def _cancel(self, handle: Any, ended: Future, run: StepRun) -> None:
        handle.cancel_goal_async()
        run.stop()
        with contextlib.suppress(TookTooLong):
            wait_for(ended, CancelToken(), CANCEL_S)
        if not ended.done():
            log.error("action_not_cancelled", interface=self._name, waited_s=CANCEL_S)


def _cancel_late(sent: Future) -> None:
    """A goal that is accepted when nobody wants it any more."""
    if sent.exception() is None and sent.result() is not None and sent.result().accepted:
        sent.result().cancel_goal_async()


class _Hears(_Base):
    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        super().__init__(planned, node, clock)
        self._topic: Topic = getattr(self._step, planned.way)
        self._newest = Newest(clock)
        qos = interface_profile(latched=self._topic.latched, heard=True)
        node.create_subscription(planned.type, self._name, self._newest.take, qos)


class Reads(_Hears):
    """Answers with the newest message of a topic."""

    def run(self, run: StepRun) -> dict[str, Any]:
        oldest_s = float("inf") if self._topic.latched else READ_S
        message = self._newest.young(oldest_s)
        if message is None:
            timeout_s = min(READ_S, self._step.timeout_s)
            try:
                message = self._newest.wait(lambda _: True, run.token, timeout_s, kept=False)
            except TookTooLong:
                raise self._failed("unheard") from None
        return values_of(self._planned, message, run.values)


class WaitsForMessage(_Hears):
    """Waits until a message says that something is so."""

    def run(self, run: StepRun) -> dict[str, Any]:
        how: Wait = getattr(self._step, self._planned.way)
        # After another step only what came since is an answer to it, also if it was there at once.
        oldest_s = READ_S if run.asked_s is None else self._clock.now() - run.asked_s
        fresh = self._topic.latched or self._newest.young(min(READ_S, oldest_s)) is not None
        try:
            message = self._newest.wait(
                lambda one: holds(one, how.until, run.values),
                run.token,
                self._step.timeout_s,
                kept=fresh,
            )
        except TookTooLong:
            raise self._failed("not_so") from None
        return values_of(self._planned, message, run.values)


_KINDS: Mapping[str, Callable[[PlannedStep, Node, Clock], LiveStep]] = {
    "publish": Publishes,
    "call": Calls,
    "action": Acts,
    "read": Reads,
    "wait": WaitsForMessage,
}
