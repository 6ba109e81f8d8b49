"""The interface of a simulator for a 2D robot: it lets time pass and returns the robot's motion.

Everything else (planner, command mux, battery, rooms) is the robot's own and the same in every
simulator. Nothing here may be used from two threads at a time; the robot locks.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Protocol

from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D

STEP_S = 0.02
"""Physical time of one step."""
BRAKE_M_S2 = 12.0
"""The robot's hardest braking; a halt from 0.8 m/s takes 0.07 s."""
STILL_M_S = 1e-4
"""Below this, in m/s or rad/s, a thing stands still."""


@dataclass(frozen=True, slots=True)
class MotionState:
    """The robot's pose and velocity, and the names of the things that it touches."""

    pose: Pose2D
    twist: Twist2D
    touching: frozenset[str]

    @property
    def finite(self) -> bool:
        """Whether every number is finite: a sum is not if one of its numbers is not."""
        pose, twist = self.pose, self.twist
        along = pose.x_m + pose.y_m + pose.yaw_rad
        return isfinite(along + twist.linear_m_s + twist.angular_rad_s)


class Engine(Protocol):
    """A world in a simulator, stepped by hand."""

    def step(self, command: Twist2D) -> MotionState:
        """Let `STEP_S` pass while the wheels follow the command; returns what came of it."""

    def motion(self) -> MotionState:
        """The robot now."""

    @property
    def still(self) -> bool:
        """Whether nothing moves: neither the robot nor the pushable things."""

    def movable_poses(self) -> tuple[Pose2D, ...]:
        """Return the poses of the pushable things, in the world's order."""

    def scan(self, time_s: float) -> LidarScan:
        """Return a sweep of the robot's lidar, stamped with this time."""

    def put(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        """Put the robot and the movable things there, at rest."""
