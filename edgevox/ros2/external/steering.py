"""Steers a robot by velocities, for robots that take no goals: straight there, around nothing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.command_mux import STILL
from edgevox.robots.path_follower import PathFollower
from edgevox.ros2.external.external_settings import Patience, SteeringLimits
from edgevox.ros2.external.motion_bounds import Jump
from edgevox.ros2.external.target import PoseEstimate, Target

_FACING_RAD = 0.05
_TURN_GAIN = 1.5
_STOPPED_M_S, _STOPPED_RAD_S = 0.02, 0.05
_CORRECTED_M = 0.3
"""Between two looks nothing drives so far; localisation has corrected the robot's place."""


class OwnSteering:
    """Turns towards the target, drives there in a straight line, turns as asked, and stands.

    It plans no way. If scans arrive, it waits for what stands in its way, and gives up in time.
    `scan` gives the newest, or raises `SkillFailed` where it cannot be believed.
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
        self._waiting_since_s: float | None = None

    @property
    def waiting(self) -> bool:
        """Whether it stands for something in its way."""
        return self._waiting_since_s is not None

    def available(self) -> bool:
        return True

    def begin(self, target: Target, estimate: PoseEstimate) -> None:
        self._target = target
        self._go_from(estimate.pose)
        self._waiting_since_s = None

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
        self._waiting_since_s = None

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
        if wanted.linear_m_s <= 0 or not blocked(self._scan(), reach_m, limits.half_width_m):
            self._waiting_since_s = None
            return wanted
        if self._waiting_since_s is None:
            self._waiting_since_s = now_s
        elif now_s - self._waiting_since_s > limits.wait_s:
            raise SkillFailed(because("in_my_way"))
        return STILL


def blocked(scan: LidarScan | None, reach_m: float, half_width_m: float) -> bool:
    """Whether a scan shows anything in the strip before the robot, this far from its middle."""
    if scan is None:
        return False
    # Minus infinity is nearer than the lidar can tell (REP 117), which is near enough.
    ranges = np.where(np.isneginf(scan.ranges_m), scan.range_min_m, scan.ranges_m)
    valid = np.isfinite(ranges) & (ranges >= scan.range_min_m) & (ranges <= scan.range_max_m)
    ahead, aside = scan.ends(np.where(valid, ranges, 0.0))[valid].T
    return bool(np.any((ahead > 0) & (ahead < reach_m) & (np.abs(aside) < half_width_m)))
