"""Drives by Nav2's ``navigate_to_pose`` action, where nav2_msgs can be imported; cancels it always.

Cancelling needs no type of Nav2's own: any action is cancelled by an `action_msgs` service.
"""

from collections.abc import Callable
from typing import Any
from uuid import uuid4

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.ros2.external.motion import PoseEstimate, Target, goal_message
from edgevox.ros2.external.settings import Patience
from edgevox.ros2.standard_topics import NAV2_ACTION as ACTION

log = get_logger(__name__)

ANSWER_S = 5.0
"""Seconds that the server may take to accept a goal."""
LONGEST_WAY_M = 1e6
"""A remaining distance beyond this, or no number, is ignored."""
LOST_S = 1.0
"""An answer to a cancel that takes longer is lost."""


class Nav2Cancel:
    """Cancels every goal of the ``navigate_to_pose`` action, of any sender."""

    def __init__(self, node: Node, clock: Clock) -> None:
        self._clock = clock
        self._client = node.create_client(CancelGoal, f"{ACTION}/_action/cancel_goal")
        self._answer: Future | None = None
        self._asked_s = 0.0

    @property
    def pending(self) -> bool:
        """Whether a cancel request is on its way, which would hit a goal that is sent now."""
        if self._answer is None or self._answer.done():
            return False
        return self._clock.now() - self._asked_s < LOST_S

    def cancel_all(self) -> bool:
        """Ask for it, without waiting; False if there is no such action."""
        if not self._client.service_is_ready():
            return False
        if self._answer is not None and not self._answer.done():
            self._client.remove_pending_request(self._answer)
        self._answer = self._client.call_async(CancelGoal.Request())  # an empty id means all
        self._asked_s = self._clock.now()
        return True


class Nav2Action:
    """Sends the target as a goal of the action, and knows its end and the way that is left."""

    name = ACTION
    waiting = False

    def __init__(
        self, node: Node, action: Any, cancel_all: Callable[[], bool], patience: Patience
    ) -> None:
        self.patience = patience
        self._action = action
        self._cancel_all = cancel_all
        self._client = ActionClient(node, action, ACTION)
        # Answers of a service get lost while it is being discovered; this topic keeps what it said.
        node.create_subscription(
            GoalStatusArray,
            f"{ACTION}/_action/status",
            self._see,
            qos_profile_action_status_default,
        )
        self._target = Target(0.0, 0.0)
        self._begun_s: float | None = None
        self._run: _Nav2Run | None = None

    def available(self) -> bool:
        return bool(self._client.server_is_ready())

    def begin(self, target: Target, estimate: PoseEstimate) -> None:
        goal = self._action.Goal()
        goal.pose = goal_message(target, estimate)
        self._target, self._begun_s = target, None
        self._run = run = _Nav2Run()
        answer = self._client.send_goal_async(
            goal, feedback_callback=run.hear, goal_uuid=UUID(uuid=run.id)
        )
        answer.add_done_callback(run.answered)

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:  # noqa: ARG002 - Nav2 knows where it is
        run = self._run
        if run is None:
            return False
        self._begun_s = now_s if self._begun_s is None else self._begun_s
        if run.refused or (not run.accepted and now_s - self._begun_s > ANSWER_S):
            raise SkillFailed(because("nav2_refused"))
        if run.status is None:
            return False
        if run.status != GoalStatus.STATUS_SUCCEEDED:
            cancelled = run.status == GoalStatus.STATUS_CANCELED
            how = because("nav2_cancelled") if cancelled else because("nav2_gave_up")
            raise SkillFailed(because("nav2_ended", how=how))
        return True

    def left_m(self, estimate: PoseEstimate) -> float:
        said = self._run.left_m if self._run else None
        return self._target.distance_m(estimate.pose) if said is None else said

    def cancel(self, estimate: PoseEstimate | None) -> None:  # noqa: ARG002
        self._run = None
        self._cancel_all()

    def _see(self, message: GoalStatusArray) -> None:
        run = self._run
        for one in message.status_list if run else ():
            if run and list(one.goal_info.goal_id.uuid) == run.id:
                run.see(one)


class _Nav2Run:
    """A goal of the action; its callbacks come on the executor's thread."""

    def __init__(self) -> None:
        self.id = list(uuid4().bytes)
        self.accepted = False
        self.refused = False
        self.status: int | None = None
        self.left_m: float | None = None

    def hear(self, message: Any) -> None:
        left_m = float(message.feedback.distance_remaining)
        self.left_m = left_m if 0.0 <= left_m <= LONGEST_WAY_M else None

    def answered(self, answer: Future) -> None:
        self.refused = not answer.result().accepted

    def see(self, status: GoalStatus) -> None:
        self.accepted = True
        if status.status >= GoalStatus.STATUS_SUCCEEDED:
            self.status = int(status.status)


def nav2_action(
    node: Node, cancel_all: Callable[[], bool], patience: Patience
) -> Nav2Action | None:
    """The backend, or None where nav2_msgs cannot be imported."""
    try:
        from nav2_msgs.action import NavigateToPose
    except ImportError:
        log.debug("nav2_msgs_missing", instead="goal_pose")
        return None
    return Nav2Action(node, NavigateToPose, cancel_all, patience)
