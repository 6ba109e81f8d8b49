"""A runner of actions: runs one to its end, or cancels it when the caller stops waiting."""

import contextlib
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.ros2.clients.clients import InterfaceClient, NodeBusy, on_node_thread
from edgevox.ros2.clients.waiting import TookTooLong, wait_for

log = get_logger(__name__)

CANCEL_S = 5.0
"""Seconds that a cancelled action may take to end."""
FEEDBACK_DEPTH = 10
"""Feedback messages that may wait for the skill; beyond that, the oldest is lost."""


class ActionRunner(InterfaceClient):
    """An action's client."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        super().__init__(node, kind, name, clock)
        self._client = ActionClient(node, kind, name)

    def run(
        self,
        goal: Any,
        token: CancelToken,
        timeout_s: float,
        hear: Callable[[Any], None] = lambda _: None,
        give_up: Callable[[], None] = lambda: None,
    ) -> Any:
        """Run the action and return its result; `hear` gets its feedback, on the calling thread.

        `give_up` is called when an accepted goal was cancelled and may still be running.

        Raises `SkillFailed` with the reason, `Cancelled`, or the error of `hear`. In each of these
        cases the action has been cancelled, and has ended if it did so within `CANCEL_S`.
        """
        self.until_there(self._client.server_is_ready, token, timeout_s, "not_there")
        until_s = self._clock.now() + timeout_s
        feedback = _Feedback()
        sent = self._ask(lambda: self._client.send_goal_async(goal, feedback.take))
        try:
            handle = wait_for(sent, token, timeout_s)
        except (TookTooLong, Cancelled) as end:
            sent.add_done_callback(_cancel_late)
            raise end if isinstance(end, Cancelled) else self.failed("no_answer") from None
        if not handle.accepted:
            raise self.failed("refused")
        ended = self._ask(handle.get_result_async)
        try:
            self._follow(ended, feedback, token, until_s, hear)
        except BaseException as end:
            self._cancel(handle, ended, give_up)
            if isinstance(end, TookTooLong):
                raise self.failed("no_answer") from None
            raise
        if ended.result().status != GoalStatus.STATUS_SUCCEEDED:
            raise self.failed("gave_up")
        return ended.result().result

    def _follow(
        self,
        ended: Future,
        feedback: "_Feedback",
        token: CancelToken,
        until_s: float,
        hear: Callable[[Any], None],
    ) -> None:
        """Hand on the feedback until it has ended. Raises `Cancelled`, or `TookTooLong`."""
        ended.add_done_callback(lambda _: feedback.wake())
        forget = token.on_cancel(feedback.wake)
        try:
            while not ended.done():
                token.check()
                if (left_s := until_s - self._clock.now()) <= 0:
                    raise TookTooLong
                for one in feedback.wait(left_s):
                    hear(one)
        finally:
            forget()

    def _ask(self, ask: Callable[[], Future]) -> Future:
        """Ask on the node's thread: rclpy loses an answer that comes before it noted the question.

        Raises `SkillFailed`.
        """
        try:
            return on_node_thread(self._node, lambda _: ask())
        except NodeBusy:
            raise self.failed("no_answer") from None

    def _cancel(self, handle: Any, ended: Future, give_up: Callable[[], None]) -> None:
        with contextlib.suppress(SkillFailed):
            self._ask(handle.cancel_goal_async)
        give_up()
        with contextlib.suppress(TookTooLong):
            wait_for(ended, CancelToken(), CANCEL_S)
        if not ended.done():
            log.error("action_not_cancelled", interface=self.name, waited_s=CANCEL_S)


class _Feedback:
    """A queue of feedback from the node's thread, which must not wait, to the skill's."""

    def __init__(self) -> None:
        self._changed = threading.Event()
        self._messages: deque[Any] = deque(maxlen=FEEDBACK_DEPTH)

    def take(self, message: Any) -> None:
        self._messages.append(message.feedback)
        self._changed.set()

    def wake(self) -> None:
        self._changed.set()

    def wait(self, timeout_s: float) -> list[Any]:
        """Wait for a message or `wake`; return the messages since the last call."""
        self._changed.wait(timeout_s)
        self._changed.clear()
        return [self._messages.popleft() for _ in range(len(self._messages))]


def _cancel_late(sent: Future) -> None:
    """Cancel a goal that is accepted after the caller has stopped waiting."""
    if sent.exception() is None and sent.result() is not None and sent.result().accepted:
        sent.result().cancel_goal_async()
