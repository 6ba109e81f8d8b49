"""What a simulator does for a 2D robot: it lets time pass and says what came of it.

Everything else, the planner, the command mux, the battery, the rooms, is the robot's own and the
same in every simulator. Nothing here is safe to use from two threads at a time; the robot locks.
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
"""How hard the robot can brake; a halt from 0.8 m/s takes 0.07 s."""
STILL_M_S = 1e-4
"""What moves slower than this, or turns slower in rad/s, stands."""


@dataclass(frozen=True, slots=True)
class MotionState:
    """Where the robot is, how it moves, and the names of what it touches."""

    pose: Pose2D
    twist: Twist2D
    touching: frozenset[str]

    @property
    def finite(self) -> bool:
        """Whether every number is one: a sum is none where one of them is none."""
        pose, twist = self.pose, self.twist
        along = pose.x_m + pose.y_m + pose.yaw_rad
        return isfinite(along + twist.linear_m_s + twist.angular_rad_s)


class Engine(Protocol):
    """One world in one simulator, stepped by hand."""

    def step(self, command: Twist2D) -> MotionState:
        """Let `STEP_S` pass while the wheels follow the command; returns what came of it."""

    def motion(self) -> MotionState:
        """The robot now."""

    @property
    def still(self) -> bool:
        """Whether nothing moves, the robot and the things that can be pushed."""

    def movable_poses(self) -> tuple[Pose2D, ...]:
        """Where the movable things are, in the world's order."""

    def scan(self, time_s: float) -> LidarScan:
        """One sweep of the robot's lidar, marked with this time."""

    def put(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        """Put the robot and the movable things there, at rest."""
