"""The ways to drive a robot to a point: by goals, or by steering.

`Target` is the point, with the distance to it. `OwnSteering` steers a robot that takes no goals by
velocities: straight to the point, around nothing.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import Header

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D, lift, turn_between
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.command_mux import STILL
from edgevox.robots.path_follower import PathFollower
from edgevox.robots.relative_motion import Lookout, blocked
from edgevox.ros2.clients import type_name
from edgevox.ros2.external.settings import Jump, Patience, SteeringLimits
from edgevox.ros2.external.topic_types import Close, TopicTypes
from edgevox.ros2.messages import pose_msg, profile
from edgevox.ros2.node import RosNode
from edgevox.ros2.stamps import to_msg
from edgevox.ros2.standard_topics import DRIVEN


@dataclass(frozen=True, slots=True)
class Target:
    """A point (m) and, if it matters, a heading (rad), in the map frame."""

    x_m: float
    y_m: float
    yaw_rad: float | None = None

    def distance_m(self, pose: Pose2D) -> float:
        """Return the straight-line distance to the target, in metres."""
        return math.hypot(self.x_m - pose.x_m, self.y_m - pose.y_m)

    def bearing_rad(self, pose: Pose2D) -> float:
        """The way to it from there; the pose's own heading if it is there."""
        if self.distance_m(pose) < 1e-6:
            return pose.yaw_rad
        return math.atan2(self.y_m - pose.y_m, self.x_m - pose.x_m)

    def turn_rad(self, pose: Pose2D) -> float:
        """Return the turn to the wanted heading, counter-clockwise; 0 without one."""
        if self.yaw_rad is None:
            return 0.0
        return turn_between(pose.yaw_rad, self.yaw_rad)


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """The robot's pose and motion."""

    pose: Pose2D
    twist: Twist2D
    frame: str
    """The map frame, or the odometry's, taken for the map."""
    stamp_ns: int
    """The robot's own time, in nanoseconds."""


def describe(estimate: PoseEstimate | None) -> dict[str, Any]:
    """Return the robot's pose and motion in the form of `robot_state`."""
    if estimate is None:
        return {"frame": None, "pose": None, "velocity": None}
    pose, twist = estimate.pose, estimate.twist
    return {
        "frame": estimate.frame,
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
    }


_FACING_RAD = 0.05
_TURN_GAIN = 1.5
_STOPPED_M_S, _STOPPED_RAD_S = 0.02, 0.05
_CORRECTED_M = 0.3
"""Between two looks nothing drives so far; localisation has corrected the robot's place."""


class OwnSteering:
    """Turns towards the target, drives there in a straight line, turns as asked, and stands.

    It plans no path. If there are scans, it waits for an obstacle on its way to move, and gives up
    after a while. `scan` returns the newest scan, or raises `SkillFailed` if it is implausible.
    """

    name = "cmd_vel"

    def __init__(
        self,
        turn: Callable[[Twist2D], None],
        scan: Callable[[], LidarScan | None],
        limits: SteeringLimits,
        patience: Patience,
    ) -> None:
        slowest_m_s = min(patience.slowest_m_s, limits.max_linear_m_s / 4)
        self.patience = replace(patience, slowest_m_s=slowest_m_s)
        self._turn, self._scan, self._limits = turn, scan, limits
        self._target = Target(0.0, 0.0)
        self._here = Pose2D(0.0, 0.0, 0.0)
        self._follower = PathFollower([(0.0, 0.0)], limits)
        self._lookout = Lookout(limits.wait_s)

    @property
    def waiting(self) -> bool:
        """Whether it waits for an obstacle."""
        return self._lookout.waiting

    def available(self) -> bool:
        return True

    def begin(self, target: Target, estimate: PoseEstimate) -> None:
        self._target = target
        self._go_from(estimate.pose)
        self._lookout.rest()

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:
        if Jump.between(self._here, estimate.pose).distance_m > _CORRECTED_M:
            self._go_from(
                estimate.pose
            )  # the way from where it was thought to be is no way any more
        self._here = estimate.pose
        wanted = self._follower.steer(estimate.pose)
        if self._follower.arrived:
            wanted = self._face(estimate)
        self._turn(self._heed(now_s, wanted, self._target.distance_m(estimate.pose)))
        stopped = (
            abs(estimate.twist.linear_m_s) < _STOPPED_M_S
            and abs(estimate.twist.angular_rad_s) < _STOPPED_RAD_S
        )
        return self._follower.arrived and wanted == STILL and stopped

    def left_m(self, estimate: PoseEstimate) -> float:
        return self._target.distance_m(estimate.pose)

    def cancel(self, estimate: PoseEstimate | None) -> None:  # noqa: ARG002 - the body holds zero
        self._lookout.rest()

    def _go_from(self, pose: Pose2D) -> None:
        self._here = pose
        way = [(pose.x_m, pose.y_m), (self._target.x_m, self._target.y_m)]
        self._follower = PathFollower(way, self._limits)

    def _face(self, estimate: PoseEstimate) -> Twist2D:
        left = self._target.turn_rad(estimate.pose)
        if abs(left) < _FACING_RAD:
            return STILL
        most = self._limits.max_angular_rad_s
        return Twist2D(0.0, min(max(_TURN_GAIN * left, -most), most))

    def _heed(self, now_s: float, wanted: Twist2D, left_m: float) -> Twist2D:
        """Zero while something is in the way of a robot that wants to go forward."""
        limits = self._limits
        # What stands behind the target is in nobody's way.
        reach_m = min(limits.stop_ahead_m, left_m + limits.half_width_m)
        ahead = wanted.linear_m_s > 0 and blocked(self._scan(), reach_m, limits.half_width_m)
        return self._lookout.heed(now_s, wanted, in_the_way=ahead)


class MotionBackend(Protocol):
    """A way to drive. `begin`, `tick` and `cancel` are quick and called under the body's lock."""

    name: str
    patience: Patience

    @property
    def waiting(self) -> bool:
        """Whether the robot stands on its way for a good reason."""

    def available(self) -> bool:
        """Return whether this way is usable, as far as the graph is known."""

    def begin(self, target: Target, estimate: PoseEstimate) -> None: ...

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:
        """Go on; True once there and standing. Raises `SkillFailed` when it cannot."""

    def left_m(self, estimate: PoseEstimate) -> float:
        """Return the remaining distance, in metres."""

    def cancel(self, estimate: PoseEstimate | None) -> None:
        """Forget the target. The body holds zero velocity beside this."""


class VelocityPublisher:
    """Publishes velocities on ``cmd_vel``, in each type that the robot takes.

    `header` gives the header of a velocity with a stamp: the robot's frame and the robot's time.
    """

    def __init__(self, ros: RosNode, types: TopicTypes, header: Callable[[], Header]) -> None:
        self._ros, self._header = ros, header
        self._publishers: list[Publisher] = []
        self._moving = False
        kinds = {type_name(kind): kind for kind in (Twist, TwistStamped)}
        types.follow(
            "cmd_vel",
            {name: partial(self._open, kind) for name, kind in kinds.items()},
            beside={name: partial(self._open_beside, kind) for name, kind in kinds.items()},
        )

    def turn(self, twist: Twist2D) -> None:
        self._moving = twist != STILL
        for one in self._publishers:
            self._publish(one, twist)

    def _publish(self, publisher: Publisher, twist: Twist2D) -> None:
        message = Twist()
        message.linear.x = float(twist.linear_m_s)
        message.angular.z = float(twist.angular_rad_s)
        stamped = publisher.msg_type is TwistStamped
        publisher.publish(
            TwistStamped(header=self._header(), twist=message) if stamped else message
        )

    def _open(self, kind: type[Any]) -> Close:
        publisher = self._create(self._ros.node, "cmd_vel", kind)

        def close() -> None:
            if self._moving:  # what still listens is not left driving
                self._publish(publisher, STILL)
            self._publishers.remove(publisher)
            self._ros.node.destroy_publisher(publisher)

        return close

    def _open_beside(self, kind: type[Any]) -> Close:
        node, leave = self._ros.beside(f"_cmd_vel_{kind.__name__}")
        publisher = self._create(node, self._ros.node.resolve_topic_name("cmd_vel"), kind)

        def close() -> None:
            self._publishers.remove(publisher)
            leave()

        return close

    def _create(self, node: Node, topic: str, kind: type[Any]) -> Publisher:
        publisher = node.create_publisher(kind, topic, profile(DRIVEN["cmd_vel"].qos))
        self._publishers.append(publisher)
        return publisher


class GoalTopicBackend:
    """Sends the target on ``goal_pose`` to its subscribers, e.g. Nav2's bt_navigator."""

    name = "goal_pose"
    waiting = False
    ARRIVED_M = 0.35
    """Nav2 is content within 0.25 m, by its own idea of where the robot is."""
    MATCH_S = 3.0
    STANDING_S = 0.5

    def __init__(
        self, node: Node, cancel_all: Callable[[], bool], patience: Patience, types: TopicTypes
    ) -> None:
        """`cancel_all` asks what drives there to drop its goals; False where it cannot be asked."""
        self.patience = patience
        self._node = node
        self._cancel_all = cancel_all
        self._types = types
        self._topic = node.resolve_topic_name("goal_pose")
        types.follow("goal_pose", {type_name(PoseStamped): self._open})
        self._target = Target(0.0, 0.0)
        self._sent = False
        self._begun_s: float | None = None
        self._still_since_s: float | None = None

    def _open(self) -> Close:
        quality = profile(DRIVEN["goal_pose"].qos)
        self._publisher = self._node.create_publisher(PoseStamped, "goal_pose", quality)
        return lambda: None  # it knows one type

    def available(self) -> bool:
        return self._node.count_subscribers(self._topic) > 0 and not self._types.unfit("goal_pose")

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
        """Make the driving node forget its goal, whoever sent it.

        A topic has no cancel. If the action has none either, the goal becomes the robot's own
        place.
        """
        if self._cancel_all() or estimate is None:
            return
        if self._publisher.get_subscription_count() > 0:
            self._publish(
                Target(estimate.pose.x_m, estimate.pose.y_m, estimate.pose.yaw_rad), estimate
            )

    def _send_once(self, estimate: PoseEstimate) -> bool:
        """Send it as soon as there is a subscriber, since an earlier message would be lost."""
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
