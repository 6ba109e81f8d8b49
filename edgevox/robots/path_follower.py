"""Pure pursuit: steers along the arc to a point a little ahead on the path."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Protocol

from edgevox.core.transforms import Pose2D, turn_between
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.shapes import Point

LOOKAHEAD_M = 0.35
ARRIVED_M = 0.06
_TURN_FROM_RAD = 0.7
_TURN_UNTIL_RAD = 0.15
_CREEP_M_S = 0.06
_TURN_GAIN = 4.0


class FollowerLimits(Protocol):
    """The limits of a robot's driving, turning and braking."""

    @property
    def max_linear_m_s(self) -> float: ...

    @property
    def max_angular_rad_s(self) -> float: ...

    @property
    def max_linear_m_s2(self) -> float: ...


@dataclass(frozen=True, slots=True)
class _Side:
    """A straight piece of a path."""

    a: Point
    """Its first point."""
    ahead: Point
    """The unit vector from `a` to `b`."""
    b: Point
    """Its last point."""
    length_m: float
    begin_m: float
    """The path's length up to `a`."""
    end_m: float
    """The path's length up to `b`."""

    def at(self, along_m: float) -> Point:
        """The point this far along the path, which is on this side."""
        past_m = along_m - self.begin_m
        return self.a[0] + past_m * self.ahead[0], self.a[1] + past_m * self.ahead[1]

    def nearest(self, point: Point) -> float:
        """Return how far along the path this side's nearest point to `point` is."""
        x, y = point[0] - self.a[0], point[1] - self.a[1]
        past_m = x * self.ahead[0] + y * self.ahead[1]
        if past_m <= 0.0:
            return self.begin_m
        return self.begin_m + past_m if past_m < self.length_m else self.end_m


class PathFollower:
    """Drives one robot along one path; asked for a velocity at every control step."""

    def __init__(self, path: Sequence[Point], limits: FollowerLimits) -> None:
        self._limits = limits
        self._sides = _sides(path)
        """The sides that are not passed yet."""
        self.goal = path[-1]
        self.length_m = self._sides[-1].end_m if self._sides else 0.0
        self._passed_m = 0.0
        self._turning = True
        self.arrived = not self._sides

    @property
    def remaining_m(self) -> float:
        """The length of the rest of the path."""
        return self.length_m - self._passed_m

    def ahead(self) -> tuple[Point, ...]:
        """Return the rest of the path, from the robot's last place on it."""
        later = [side.b for side in self._sides if side.end_m > self._passed_m]
        return (self._at(self._passed_m), *later)

    def steer(self, pose: Pose2D) -> Twist2D:
        """The velocity to ask for now. Zero once arrived, and it stays arrived."""
        here = (pose.x_m, pose.y_m)
        self._get_on(here)
        left = math.dist(here, self.goal)
        if self.arrived or (self.remaining_m < LOOKAHEAD_M and left < ARRIVED_M):
            self.arrived = True
            return Twist2D(0.0, 0.0)
        target = self._at(self._passed_m + LOOKAHEAD_M)
        off = _heading_error(pose, target)
        self._turning = abs(off) > (_TURN_UNTIL_RAD if self._turning else _TURN_FROM_RAD)
        if self._turning:
            return Twist2D(0.0, self._turn_rate(_TURN_GAIN * off))
        curvature = 2.0 * math.sin(off) / max(math.dist(here, target), ARRIVED_M)
        speed = self._speed(max(left, self.remaining_m), curvature)
        return Twist2D(speed, self._turn_rate(speed * curvature))

    def _speed(self, left_m: float, curvature: float) -> float:
        """Return the speed that the limits, the distance for stopping and the bend allow."""
        limits = self._limits
        stopping = math.sqrt(max(limits.max_linear_m_s2 * (left_m - ARRIVED_M / 2), 0.0))
        turning = 0.7 * limits.max_angular_rad_s / max(abs(curvature), 1e-6)
        return min(limits.max_linear_m_s, max(min(stopping, turning), _CREEP_M_S))

    def _turn_rate(self, wanted: float) -> float:
        most = self._limits.max_angular_rad_s
        return min(max(wanted, -most), most)

    def _at(self, along_m: float) -> Point:
        for side in self._sides:
            if along_m <= side.end_m:
                return side.at(along_m)
        return self.goal

    def _get_on(self, here: Point) -> None:
        """Find where on the path the robot is, only a little ahead, so that no loop is cut."""
        passed_m, least_m = self._passed_m, math.inf
        for side in self._sides:
            if side.begin_m > self._passed_m + LOOKAHEAD_M:
                break
            along_m = side.nearest(here)
            gap_m = math.dist(here, side.at(along_m))
            if gap_m < least_m and along_m <= self._passed_m + 2 * LOOKAHEAD_M:
                passed_m, least_m = along_m, gap_m
        self._passed_m = max(self._passed_m, passed_m)
        while self._sides and self._sides[0].end_m < self._passed_m:
            del self._sides[0]


def _sides(path: Sequence[Point]) -> list[_Side]:
    pairs = [(a, b) for a, b in pairwise(path) if a != b]
    lengths = [math.dist(a, b) for a, b in pairs]
    marks = pairwise(accumulate(lengths, initial=0.0))
    return [
        _Side(
            a,
            ((b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m),
            b,
            length_m,
            begin_m,
            end_m,
        )
        for (a, b), length_m, (begin_m, end_m) in zip(pairs, lengths, marks, strict=True)
    ]


def _heading_error(pose: Pose2D, target: Point) -> float:
    bearing = math.atan2(target[1] - pose.y_m, target[0] - pose.x_m)
    return turn_between(pose.yaw_rad, bearing)
