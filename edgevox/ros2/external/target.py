"""Where a drive goes to, and how far that is."""

import math
from dataclasses import dataclass
from typing import Any

from edgevox.core.transforms import Pose2D, turn_between
from edgevox.robots.capabilities import Twist2D


@dataclass(frozen=True, slots=True)
class Target:
    """A point (m) and, if it matters, a heading (rad), in the map frame."""

    x_m: float
    y_m: float
    yaw_rad: float | None = None

    def distance_m(self, pose: Pose2D) -> float:
        """How far away it is, as the crow flies."""
        return math.hypot(self.x_m - pose.x_m, self.y_m - pose.y_m)

    def bearing_rad(self, pose: Pose2D) -> float:
        """The way to it from there; the pose's own heading if it is there."""
        if self.distance_m(pose) < 1e-6:
            return pose.yaw_rad
        return math.atan2(self.y_m - pose.y_m, self.x_m - pose.x_m)

    def turn_rad(self, pose: Pose2D) -> float:
        """How much to turn for the heading asked for, counter-clockwise; 0 if none is."""
        if self.yaw_rad is None:
            return 0.0
        return turn_between(pose.yaw_rad, self.yaw_rad)


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """Where the robot is and how it moves, in `frame`: the map, or odometry taken for it.

    `stamp_ns` is the robot's own time.
    """

    pose: Pose2D
    twist: Twist2D
    frame: str
    stamp_ns: int


def describe(estimate: PoseEstimate | None) -> dict[str, Any]:
    """Where a robot is and how it moves, as `robot_state` says it."""
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
