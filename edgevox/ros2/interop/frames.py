"""The frames of a robot, by REP 105: their names, their transforms, and the odometry frame.

`map` is shared by all robots of a domain, so it has no prefix; every frame of one robot has: with
``robot1/``, `robot1/odom`, `robot1/base_link`, and so on. Nav2's examples of several robots with
one map and robot_state_publisher's `frame_prefix` do the same.

Transforms go out on `/tf` and `/tf_static`, names that all robots of a domain share.

REP 105 demands two things of the odometry frame: a pose in `odom` never jumps, and `map -> odom ->
base_link` is the pose on the map. The body knows its true pose, so `odom` is the robot's pose at
the start and stays there, until the robot is put elsewhere (a reset): then `odom` moves with it.
"""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from rclpy.node import Node

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import (
    BASE,
    IDENTITY,
    MAP,
    ODOM_EXPECTED,
    ODOM_FRAMES,
    PREFIX_EXPECTED,
    Pose3D,
    angle,
    compose,
    distance,
    inverse,
    is_prefix,
)
from edgevox.ros2.messages import profile, transform_msg
from edgevox.ros2.stamps import StampedPublisher
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose
from tf2_msgs.msg import TFMessage


class Broadcaster:
    """Publishes what moves."""

    def __init__(self, node: Node) -> None:
        self._publisher = StampedPublisher(node, TFMessage, "/tf")

    def send(self, placed: Sequence[FramePose], stamp_ns: int) -> None:
        """Publish the poses of the frames at this stamp."""
        self._publisher.say(placed, lambda stamp: _message(placed, stamp), stamp_ns)


def broadcast_fixed(node: Node, placed: Sequence[FramePose]) -> None:
    """Publish fixed transforms, for present and late subscribers; call it once."""
    node.create_publisher(TFMessage, "/tf_static", profile(STANDARD["/tf_static"].qos)).publish(
        _message(placed, Time())
    )


def _message(placed: Sequence[FramePose], stamp: Time) -> TFMessage:
    return TFMessage(
        transforms=[transform_msg(one.parent, one.child, one.pose, stamp) for one in placed]
    )


_SLACK_M = 0.05
_SLACK_RAD = 0.2
_HURRY = 2.0
"""A step this many times as large as the body's speed allows is no motion."""


class Odometer:
    """Keeps `map -> odom`. `max_linear_m_s` and `max_angular_rad_s` are the body's limits."""

    def __init__(self, max_linear_m_s: float, max_angular_rad_s: float) -> None:
        self._max_linear_m_s = max_linear_m_s
        self._max_angular_rad_s = max_angular_rad_s
        self._before: tuple[float, Pose3D] | None = None
        self._odom_to_base = IDENTITY
        self.map_to_odom = IDENTITY

    def move(self, time_s: float, pose: Pose3D) -> Pose3D:
        """The pose in `odom`, from that on the map."""
        before = self._before
        if before is not None and before[1] == pose:  # a robot at rest is asked all the time
            self._before = time_s, pose
            return self._odom_to_base
        if before is None or self._jumped(*before, time_s, pose):
            self.map_to_odom = compose(pose, inverse(self._odom_to_base))
        self._odom_to_base = compose(inverse(self.map_to_odom), pose)
        self._before = time_s, pose
        return self._odom_to_base

    def _jumped(self, then_s: float, then: Pose3D, now_s: float, now: Pose3D) -> bool:
        passed_s = max(now_s - then_s, 0.0)
        far_m = _SLACK_M + _HURRY * self._max_linear_m_s * passed_s
        far_rad = _SLACK_RAD + _HURRY * self._max_angular_rad_s * passed_s
        return distance(then, now) > far_m or angle(then, now) > far_rad


HAND = "ee_link"
LIDAR = "lidar_link"
CAMERA = "camera_link"
CAMERA_OPTICAL = "camera_optical_frame"
"""Turned as REP 103 wants pictures: z forward, x right, y down."""


class Frames:
    """The full names of one robot's frames.

    `odom` is the name of the odometry frame, or empty if `base_link` hangs on `map` directly.
    Raises `InvalidValue` for a name that tf2 would not take.
    """

    def __init__(self, odom: str = "", prefix: str = "") -> None:
        if odom not in ODOM_FRAMES:
            raise InvalidValue("odom_frame", odom, ODOM_EXPECTED)
        if not is_prefix(prefix):
            raise InvalidValue("frame_prefix", prefix, PREFIX_EXPECTED)
        self.map = MAP
        self.odom = f"{prefix}{odom}" if odom else ""
        self.base = f"{prefix}{BASE}"
        self.hand = f"{prefix}{HAND}"
        self.lidar = f"{prefix}{LIDAR}"
        self.camera = f"{prefix}{CAMERA}"
        self.camera_optical = f"{prefix}{CAMERA_OPTICAL}"
        self._prefix = prefix

    def names_of(self, frame: str) -> tuple[str, ...]:
        """Return the frames that a peer may mean: this name, or this robot's frame of that name."""
        return (frame, f"{self._prefix}{frame}") if frame != MAP else (frame,)
