"""The history of a robot's odometry: its pose, and whether it is silent or stands."""

import threading
from collections import deque
from dataclasses import dataclass

from edgevox.core.clock import Clock
from edgevox.core.transforms import Pose2D, distance_on_floor, turn_between
from edgevox.robots.capabilities import Twist2D
from edgevox.ros2.external.settings import Jump, Speeds, drivable, on_the_map, seconds_between
from edgevox.ros2.stamps import NS_PER_S

SILENT_S = 1.0
"""Odometry that is older than this is no position."""
STANDING_FOR_S = 0.3
"""Seconds without motion after which a robot stands."""
_STILL_M_S, _STILL_RAD_S = 0.02, 0.05
_SHIFT_M, _SHIFT_RAD = 0.01, 0.02
_MOTION_S = 0.5
"""Seconds of poses that show whether a robot moves."""
_KEPT = 64


@dataclass(frozen=True, slots=True)
class OdometrySample:
    """An odometry message."""

    pose: Pose2D
    twist: Twist2D
    frame: str
    child_frame: str
    stamp_ns: int
    """The robot's time, in nanoseconds."""
    heard_s: float
    """EdgeVox's clock at arrival, in seconds."""
    height_m: float = 0.0

    @property
    def still(self) -> bool:
        """Whether it reports no motion."""
        twist = self.twist
        return abs(twist.linear_m_s) < _STILL_M_S and abs(twist.angular_rad_s) < _STILL_RAD_S


@dataclass(frozen=True, slots=True)
class OdometryDoubt:
    """A fault of the odometry, after which a drive must not go on: the newest, with its number.

    `jump` is the jump; None for an impossible value.
    """

    number: int
    heard_s: float
    jump: Jump | None = None


class OdometryHistory:
    """The latest odometry. Thread-safe. Motion faster than `speeds` is a jump.

    `refused` counts implausible messages.
    """

    def __init__(self, clock: Clock, speeds: Speeds | None = None) -> None:
        self._clock = clock
        self._speeds = speeds or Speeds()
        self._lock = threading.Lock()
        self._heard: deque[OdometrySample] = deque(maxlen=_KEPT)
        self._doubt: OdometryDoubt | None = None
        self._lies = False
        self.refused = 0

    def add(self, sample: OdometrySample) -> bool:
        """Take a sample in; False, and forgotten, if it is implausible.

        A sample after a jump is the robot's pose from now on.
        """
        with self._lock:
            if not (on_the_map(sample.pose) and drivable(sample.twist)):
                self.refused += 1
                self._lies = True
                self._note(sample, None)
                return False
            self._lies = False
            jump = self._jump(sample)
            if jump:
                self._note(sample, jump)
            self._heard.append(sample)
        return True

    @property
    def doubt(self) -> OdometryDoubt | None:
        """The newest fault; later samples may be good again."""
        with self._lock:
            return self._doubt

    @property
    def absurd(self) -> bool:
        """Whether the current odometry is implausible."""
        with self._lock:
            doubt, lies = self._doubt, self._lies
        return bool(lies and doubt and self._clock.now() - doubt.heard_s <= SILENT_S)

    def newest(self) -> OdometrySample | None:
        """The last one, however old."""
        with self._lock:
            return self._heard[-1] if self._heard else None

    def fresh(self) -> OdometrySample | None:
        """The last one, unless odometry is silent."""
        newest = self.newest()
        return newest if newest and self.age_s(newest) <= SILENT_S else None

    def age_s(self, sample: OdometrySample) -> float:
        """Return the sample's age in seconds."""
        return self._clock.now() - sample.heard_s

    def still(self) -> bool:
        """Return whether no motion is seen; a silent robot shows none."""
        seen = self.fresh()
        return seen is None or seen.still

    def moves(self) -> bool:
        """Return whether any motion is seen: in the newest velocity, or between recent poses.

        Poses count as well because many robots fill in their velocity in part, or not at all.
        """
        seen = self.fresh()
        if seen is None:
            return False
        with self._lock:
            recent = [one for one in self._heard if seen.heard_s - one.heard_s <= _MOTION_S]
        steady = all(
            _together(one.pose, seen.pose) and abs(one.height_m - seen.height_m) < _SHIFT_M
            for one in recent
        )
        return not (seen.still and steady)

    def _note(self, sample: OdometrySample, jump: Jump | None) -> None:
        number = self._doubt.number + 1 if self._doubt else 1
        self._doubt = OdometryDoubt(number, sample.heard_s, jump)

    def _jump(self, sample: OdometrySample) -> Jump | None:
        if not self._heard:
            return None
        last = self._heard[-1]
        seconds = seconds_between(
            sample.heard_s - last.heard_s, (sample.stamp_ns - last.stamp_ns) / NS_PER_S
        )
        return self._speeds.jump(last.pose, sample.pose, seconds)

    def stands(self, since_s: float) -> bool:
        """Return whether the robot stood at the end of the samples since then.

        Compares poses too, for robots that do not fill in their velocity.
        """
        with self._lock:
            recent = [one for one in self._heard if one.heard_s >= since_s]
        if not recent or self.age_s(recent[-1]) > SILENT_S:
            return False
        last = recent[-1]
        first = last
        for one in reversed(recent):
            if not (one.still and _together(one.pose, last.pose)):
                break
            first = one
        return last.heard_s - first.heard_s >= STANDING_FOR_S


def _together(one: Pose2D, other: Pose2D) -> bool:
    turned = abs(turn_between(one.yaw_rad, other.yaw_rad))
    return distance_on_floor(one, other) < _SHIFT_M and turned < _SHIFT_RAD
