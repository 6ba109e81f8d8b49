"""Where the feet go: plants one and swings the other, so that what stands does not slip."""

import math
from dataclasses import dataclass

from edgevox.core.transforms import Pose2D, compose_on_floor, distance_on_floor, turn_between
from edgevox.robots.humanoid.walking_policy import WalkingCommand

CYCLE_S = 0.9
"""Both feet have stepped once."""
SWING = 0.4
"""The part of a cycle in which one foot is in the air."""
LIFT_M = 0.06
AHEAD_S = (1.0 - SWING) / 2 * CYCLE_S
"""From touching down to the middle of standing on a foot."""
_AT_HOME_M = 1e-3
_AT_HOME_RAD = 2e-3


@dataclass(frozen=True, slots=True)
class Footstep:
    """A foot: where it is on the floor, how high above it, and how far through its swing (0 to 1).

    `swing` is None while it stands.
    """

    place: Pose2D
    height_m: float = 0.0
    swing: float | None = None


class FootstepPlanner:
    """Two feet, `homes` beside the base: (left, right) in its frame. They start where they belong.

    A swinging foot is lifted by `lift_m`.
    While the base moves they step by turns; once it stands they step until both are at home.
    """

    def __init__(self, homes: tuple[Pose2D, Pose2D], base: Pose2D, lift_m: float = LIFT_M) -> None:
        self._homes, self._lift_m = homes, lift_m
        self.phase = 0.0
        self.put(base)

    def put(self, base: Pose2D) -> None:
        """Both feet at home beside a base that stands there."""
        self.phase = 0.0
        self.feet = [Footstep(compose_on_floor(base, home)) for home in self._homes]
        self._from = [foot.place for foot in self.feet]

    @property
    def stepping(self) -> bool:
        """Whether a foot is in the air."""
        return any(foot.swing is not None for foot in self.feet)

    def advance(self, seconds: float, base: Pose2D, velocity: WalkingCommand) -> None:
        """Let the feet follow a base that is there and moves so."""
        if velocity.stands and not self.stepping and self._at_home(base):
            self.phase = 0.0
            return
        self.phase = (self.phase + seconds / CYCLE_S) % 1.0
        for number in (0, 1):
            self._move(number, base, velocity)

    def _move(self, number: int, base: Pose2D, velocity: WalkingCommand) -> None:
        through = ((self.phase - 0.5 * number) % 1.0) / SWING
        foot = self.feet[number]
        if through >= 1.0:
            if foot.swing is not None:
                self.feet[number] = Footstep(foot.place)
            return
        if foot.swing is None:
            self._from[number] = foot.place
        left_s = (1.0 - through) * SWING * CYCLE_S
        later = ahead(base, velocity, left_s + AHEAD_S)
        target = compose_on_floor(later, self._homes[number])
        smooth = through * through * (3.0 - 2.0 * through)
        place = between(self._from[number], target, smooth)
        height_m = self._lift_m * math.sin(math.pi * through) ** 2
        self.feet[number] = Footstep(place, height_m, through)

    def _at_home(self, base: Pose2D) -> bool:
        return all(
            _near(foot.place, compose_on_floor(base, home))
            for foot, home in zip(self.feet, self._homes, strict=True)
        )


def ahead(base: Pose2D, velocity: WalkingCommand, seconds: float) -> Pose2D:
    """Where a base will be that goes on like this: along an arc."""
    turned = velocity.turn_rad_s * seconds
    if abs(turned) < 1e-6:
        along, across = 1.0, 0.0
    else:
        along, across = math.sin(turned) / turned, (1.0 - math.cos(turned)) / turned
    x, y = velocity.forward_m_s * seconds, velocity.left_m_s * seconds
    return compose_on_floor(base, Pose2D(along * x - across * y, across * x + along * y, turned))


def between(one: Pose2D, other: Pose2D, part: float) -> Pose2D:
    """On the straight way from one to the other; yaw takes the short way round."""
    turn = turn_between(one.yaw_rad, other.yaw_rad)
    return Pose2D(
        one.x_m + part * (other.x_m - one.x_m),
        one.y_m + part * (other.y_m - one.y_m),
        one.yaw_rad + part * turn,
    )


def _near(one: Pose2D, other: Pose2D) -> bool:
    turned = abs(turn_between(one.yaw_rad, other.yaw_rad))
    return distance_on_floor(one, other) < _AT_HOME_M and turned < _AT_HOME_RAD
