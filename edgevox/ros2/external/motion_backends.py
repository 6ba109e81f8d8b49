"""The ways to make a robot drive to a point: it takes goals, or it is steered."""

from collections.abc import Callable
from typing import Protocol

from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D, lift
from edgevox.robots.capabilities import Twist2D
from edgevox.ros2.external.external_settings import Patience
from edgevox.ros2.external.target import PoseEstimate, Target
from edgevox.ros2.messages import pose_msg
from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import to_msg
from edgevox.ros2.standard_topics import DRIVEN


class MotionBackend(Protocol):
    """One way to drive. `begin`, `tick` and `cancel` are quick and called under the body's lock."""

    name: str
    patience: Patience

    @property
    def waiting(self) -> bool:
        """Whether the robot stands on its way for a good reason."""

    def available(self) -> bool:
        """Whether the robot can be driven this way, as far as the graph is known."""

    def begin(self, target: Target, estimate: PoseEstimate) -> None: ...

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:
        """Go on; True once there and standing. Raises `SkillFailed` when it cannot."""

    def left_m(self, estimate: PoseEstimate) -> float:
        """What is left of the way."""

    def cancel(self, estimate: PoseEstimate | None) -> None:
        """Forget the target. The body holds zero velocity beside this."""


class VelocityPublisher:
    """Publishes velocities on ``cmd_vel``."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(Twist, "cmd_vel", profile(DRIVEN["cmd_vel"].qos))

    def turn(self, twist: Twist2D) -> None:
        message = Twist()
        message.linear.x = float(twist.linear_m_s)
        message.angular.z = float(twist.angular_rad_s)
        self._publisher.publish(message)


class GoalTopicBackend:
    """Sends the target on ``goal_pose`` to whoever listens there, e.g. Nav2's bt_navigator."""

    name = "goal_pose"
    waiting = False
    ARRIVED_M = 0.35
    """Nav2 is content within 0.25 m, by its own idea of where the robot is."""
    MATCH_S = 3.0
    STANDING_S = 0.5

    def __init__(self, node: Node, cancel_all: Callable[[], bool], patience: Patience) -> None:
        """`cancel_all` asks what drives there to drop its goals; False where it cannot be asked."""
        self.patience = patience
        self._node = node
        self._cancel_all = cancel_all
        self._topic = node.resolve_topic_name("goal_pose")
        self._publisher = node.create_publisher(
            PoseStamped, "goal_pose", profile(DRIVEN["goal_pose"].qos)
        )
        self._target = Target(0.0, 0.0)
        self._sent = False
        self._begun_s: float | None = None
        self._still_since_s: float | None = None

    def available(self) -> bool:
        return self._node.count_subscribers(self._topic) > 0

    def begin(self, target: Target, estimate: PoseEstimate) -> None:
        self._target, self._sent = target, False
        self._begun_s = self._still_since_s = None
        self._send_once(estimate)

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:
        if self._begun_s is None:
            self._begun_s = now_s
        if not self._send_once(estimate):
            if now_s - self._begun_s > self.MATCH_S:
                raise SkillFailed(because("goals_unheard", topic=self._topic))
            return False
        near = self._target.distance_m(estimate.pose) < self.ARRIVED_M
        if not (near and _still(estimate.twist)):
            self._still_since_s = None
            return False
        if self._still_since_s is None:
            self._still_since_s = now_s
        return now_s - self._still_since_s >= self.STANDING_S

    def left_m(self, estimate: PoseEstimate) -> float:
        return self._target.distance_m(estimate.pose)

    def cancel(self, estimate: PoseEstimate | None) -> None:
        self.recall(estimate if self._sent else None)
        self._sent = False

    def recall(self, estimate: PoseEstimate | None) -> None:
        """Make what drives there forget its goal, whoever sent it.

        A topic knows no cancel. Without the action's, the goal becomes where the robot is.
        """
        if self._cancel_all() or estimate is None:
            return
        if self._publisher.get_subscription_count() > 0:
            self._publish(
                Target(estimate.pose.x_m, estimate.pose.y_m, estimate.pose.yaw_rad), estimate
            )

    def _send_once(self, estimate: PoseEstimate) -> bool:
        """Send it as soon as somebody is matched, since nobody hears what was sent before."""
        if not self._sent and self._publisher.get_subscription_count() > 0:
            self._publish(self._target, estimate)
            self._sent = True
        return self._sent

    def _publish(self, target: Target, estimate: PoseEstimate) -> None:
        self._publisher.publish(goal_message(target, estimate))


def goal_message(target: Target, estimate: PoseEstimate) -> PoseStamped:
    """The target as ROS writes it, looking on from where the robot is if no heading matters."""
    message = PoseStamped()
    message.header.frame_id = estimate.frame
    message.header.stamp = to_msg(estimate.stamp_ns)
    yaw = target.bearing_rad(estimate.pose) if target.yaw_rad is None else target.yaw_rad
    message.pose = pose_msg(lift(Pose2D(float(target.x_m), float(target.y_m), yaw)))
    return message


def _still(twist: Twist2D) -> bool:
    return abs(twist.linear_m_s) < 0.02 and abs(twist.angular_rad_s) < 0.05
