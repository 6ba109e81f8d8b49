"""Short motions of a robot on wheels from where it stands: some metres straight on, or a turn.

The loop is closed on the robot's pose. `StraightCourse` and `TurnCourse` say how to steer.
`Lookout` makes a robot wait for what stands in its way. `RelativeMotion` is the whole: it steers a
course, stops for what the lidar sees, and gives up where the robot does not get on.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D, rotate, to_map, turn_between
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.command_mux import STILL, clamped
from edgevox.robots.motion import Motion, Progress
from edgevox.robots.path_follower import FollowerLimits

_SECTOR_RAD = math.radians(30.0)
"""The beams that see a way are those within this of its direction."""
_WIDEST_GAP_RAD = math.radians(10.0)
"""Beams further apart than this could miss a table's leg."""


def blocked(
    scan: LidarScan | None, reach_m: float, half_width_m: float, *, behind: bool = False
) -> bool:
    """Return whether the scan shows an obstacle in the strip ahead of the robot, or `behind` it.

    The strip reaches `reach_m` from the robot's middle, and `half_width_m` to either side.
    """
    if scan is None:
        return False
    # Minus infinity is nearer than the lidar can tell (REP 117), which is near enough.
    ranges = np.where(np.isneginf(scan.ranges_m), scan.range_min_m, scan.ranges_m)
    valid = np.isfinite(ranges) & _in_range(scan, ranges)
    ahead, aside = scan.ends(np.where(valid, ranges, 0.0))[valid].T
    along = -ahead if behind else ahead
    return bool(np.any((along > 0) & (along < reach_m) & (np.abs(aside) < half_width_m)))


def sees(scan: LidarScan | None, *, behind: bool = False) -> bool:
    """Return whether the lidar measures all of the way ahead, or of the one `behind`.

    A beam that hits nothing is a measurement; one that is masked, or not a number, is none.
    """
    if scan is None:
        return False
    measured = np.isinf(scan.ranges_m) | _in_range(scan, scan.ranges_m)
    angles = scan.angle_min_rad + scan.angle_increment_rad * np.arange(len(scan.ranges_m))
    towards = scan.mount.yaw_rad - (math.pi if behind else 0.0)
    off = np.remainder(angles[measured] + towards + math.pi, math.tau) - math.pi
    within = np.sort(off[np.abs(off) <= _SECTOR_RAD])
    edges = np.concatenate([[-_SECTOR_RAD], within, [_SECTOR_RAD]])
    return bool(np.diff(edges).max() <= _WIDEST_GAP_RAD)


def _in_range(scan: LidarScan, ranges: NDArray[np.floating]) -> NDArray[np.bool_]:
    return (ranges >= scan.range_min_m) & (ranges <= scan.range_max_m)


ARRIVED_M = 0.01
ARRIVED_RAD = 0.01
_CREEP_M_S, _CREEP_RAD_S = 0.05, 0.1
_EASE = 0.5
"""The share of the robot's braking that a motion plans with."""
_EASE_RAD_S2 = 1.0
_HEADING_GAIN = 2.0
_ASIDE_GAIN = 1.5
_MOST_CORRECTION_RAD = 0.3
_NEARER = 0.02
"""Metres or radians that count as getting on."""
_STOPPED_M_S, _STOPPED_RAD_S = 0.02, 0.05


class Course(Protocol):
    """A way to go from the pose where it began."""

    towards: int
    """1 for a way ahead, -1 for a way back, 0 for none."""
    goal: Pose2D
    """Where it ends."""
    arrived: bool
    left: float
    """Metres or radians that are left, never less than 0."""

    def steer(self, pose: Pose2D) -> Twist2D:
        """The velocity to ask for now. Zero once arrived, and it stays arrived."""

    def progress(self) -> Progress:
        """Return the progress, in metres or degrees."""


class StraightCourse:
    """Some metres straight on, or straight back where they are negative."""

    def __init__(self, start: Pose2D, distance_m: float, limits: FollowerLimits) -> None:
        self._start, self._limits = start, limits
        self._whole_m = abs(distance_m)
        self.towards = 1 if distance_m > 0 else -1
        self.goal = Pose2D(*to_map((distance_m, 0.0), start), start.yaw_rad)
        self.left = self._whole_m
        self.arrived = False

    def steer(self, pose: Pose2D) -> Twist2D:
        start = self._start
        along, aside = rotate(pose.x_m - start.x_m, pose.y_m - start.y_m, -start.yaw_rad)
        self.left = max(self._whole_m - self.towards * along, 0.0)
        self.arrived = self.arrived or self.left < ARRIVED_M
        if self.arrived:
            return STILL
        limits = self._limits
        eased = math.sqrt(2 * _EASE * limits.max_linear_m_s2 * self.left)
        speed = min(limits.max_linear_m_s, max(eased, _CREEP_M_S))
        wanted = -self.towards * clamped(_ASIDE_GAIN * aside, _MOST_CORRECTION_RAD)
        off = turn_between(pose.yaw_rad, start.yaw_rad + wanted)
        turn = clamped(_HEADING_GAIN * off, limits.max_angular_rad_s)
        return Twist2D(self.towards * speed, turn)

    def progress(self) -> Progress:
        left = 0.0 if self.arrived else self.left
        return Progress(min(max(1.0 - left / self._whole_m, 0.0), 1.0), left, "m")


class TurnCourse:
    """A turn on the spot by an angle of any size, to the left where it is positive."""

    towards = 0

    def __init__(self, start: Pose2D, angle_rad: float, limits: FollowerLimits) -> None:
        self._limits, self._angle_rad = limits, angle_rad
        self._yaw_rad, self._turned_rad = start.yaw_rad, 0.0
        yaw_rad = turn_between(0.0, start.yaw_rad + angle_rad)
        self.goal = Pose2D(start.x_m, start.y_m, yaw_rad)
        self.left = abs(angle_rad)
        self.arrived = False

    def steer(self, pose: Pose2D) -> Twist2D:
        self._turned_rad += turn_between(self._yaw_rad, pose.yaw_rad)
        self._yaw_rad = pose.yaw_rad
        left = self._angle_rad - self._turned_rad
        self.left = abs(left)
        self.arrived = self.arrived or self.left < ARRIVED_RAD
        if self.arrived:
            return STILL
        eased = max(math.sqrt(2 * _EASE_RAD_S2 * self.left), _CREEP_RAD_S)
        return Twist2D(0.0, math.copysign(min(self._limits.max_angular_rad_s, eased), left))

    def progress(self) -> Progress:
        left = 0.0 if self.arrived else self.left
        part = 1.0 - left / abs(self._angle_rad)
        return Progress(min(max(part, 0.0), 1.0), math.degrees(left), "deg")


class Lookout:
    """Holds a robot that something is in the way of, and gives up after a while."""

    def __init__(self, wait_s: float) -> None:
        self._wait_s = wait_s
        self._since_s: float | None = None

    @property
    def waiting(self) -> bool:
        """Whether the robot waits for an obstacle to go."""
        return self._since_s is not None

    def heed(self, now_s: float, wanted: Twist2D, *, in_the_way: bool) -> Twist2D:
        """The velocity to ask for: `wanted`, or none while something is in the way.

        Raises `SkillFailed` when it has waited long enough.
        """
        if not in_the_way:
            self._since_s = None
            return wanted
        if self._since_s is None:
            self._since_s = now_s
        elif now_s - self._since_s > self._wait_s:
            raise SkillFailed(because("in_my_way"))
        return STILL

    def rest(self) -> None:
        """Forget the obstacle."""
        self._since_s = None


@dataclass(frozen=True, slots=True)
class Caution:
    """The room that a robot needs on a straight way, and how long it waits where it has none."""

    half_width_m: float
    stop_ahead_m: float
    """Something this near to the robot's middle, on its way, makes it stop."""
    wait_s: float
    """Seconds to wait for an obstacle to go."""
    patience_s: float
    """Seconds without getting on after which it gives up."""
    sighted: bool = True
    """Whether it goes ahead only where the lidar sees. It never goes back blindly."""


class RelativeMotion(Motion):
    """A course from start to end; ends on arrival, once the robot stands."""

    def __init__(
        self, course: Course, caution: Caution, scan: Callable[[], LidarScan | None], now_s: float
    ) -> None:
        """Look before it begins. Raises `SkillFailed` where it cannot see, or cannot go at all."""
        super().__init__()
        self.course = course
        self._caution, self._scan = caution, scan
        self._lookout = Lookout(caution.wait_s)
        self._best, self._better_s = course.left, now_s
        if self._is_in_the_way():
            raise SkillFailed(because("in_my_way"))

    @property
    def waiting(self) -> bool:
        """Whether it waits for an obstacle to go."""
        return self._lookout.waiting

    def go_on(self, now_s: float, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """The velocity to ask for now; it may be over afterwards.

        Raises `SkillFailed` where it gives up.
        """
        wanted = self.course.steer(pose)
        if self.course.arrived:
            stopped = (
                abs(twist.linear_m_s) < _STOPPED_M_S and abs(twist.angular_rad_s) < _STOPPED_RAD_S
            )
            if stopped:
                self.end()
            return STILL
        wanted = self._lookout.heed(now_s, wanted, in_the_way=self._is_in_the_way())
        self._lose_patience(now_s)
        return wanted

    def progress(self) -> Progress:
        return self.course.progress()

    def _is_in_the_way(self) -> bool:
        """Whether something is; raises `SkillFailed` where the robot would not see it."""
        towards, caution = self.course.towards, self._caution
        if not towards:
            return False
        scan, behind = self._scan(), towards < 0
        if (behind or caution.sighted) and not sees(scan, behind=behind):
            raise SkillFailed(because("blind_behind") if behind else because("blind_ahead"))
        # What stands behind the goal is in nobody's way.
        reach_m = min(caution.stop_ahead_m, self.course.left + caution.half_width_m)
        return blocked(scan, reach_m, caution.half_width_m, behind=behind)

    def _lose_patience(self, now_s: float) -> None:
        if self.waiting or self.course.left < self._best - _NEARER:
            self._best, self._better_s = min(self._best, self.course.left), now_s
        elif now_s - self._better_s > self._caution.patience_s:
            raise SkillFailed(because("no_further"))
