"""Poses, rigid transforms and names of frames, on the floor and in space.

A pose given in a frame is also the transform that takes points of its own frame to that frame.
Metres and radians, axes by REP 103: x ahead (east on a map), y left (north), z up, turns
counter-clockwise. Quaternions are x, y, z, w and of length 1.
tests/unit/core/test_transforms.py compares this with SciPy.
"""

import math
import re
from dataclasses import dataclass
from math import isfinite
from typing import Literal, get_args

MAP = "map"
"""The map's frame, which all robots of a domain share."""
BASE = "base_link"
ODOM = "odom"
OdomFrame = Literal["", "odom"]
"""The odometry's frame; empty if `base_link` is a child of `map`."""
ODOM_FRAMES: tuple[str, ...] = get_args(OdomFrame)
ODOM_EXPECTED = f"empty or {ODOM}"
PREFIX_EXPECTED = "empty, or a prefix such as robot1/: letters, digits, underscores and slashes"
_PREFIX = re.compile(r"([A-Za-z][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*/?)?")


def is_prefix(text: str) -> bool:
    """True for a valid prefix of frames: empty, or names with slashes, a letter first."""
    return _PREFIX.fullmatch(text) is not None


@dataclass(frozen=True, slots=True)
class Pose2D:
    """Position (m) and heading (rad, -pi to pi) in the map frame."""

    x_m: float
    y_m: float
    yaw_rad: float

    @property
    def finite(self) -> bool:
        """True if every number is finite."""
        return isfinite(self.x_m) and isfinite(self.y_m) and isfinite(self.yaw_rad)


@dataclass(frozen=True, slots=True)
class Pose3D:
    """Position (m) and orientation (unit quaternion); the identity by default."""

    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    qx: float = 0.0
    qy: float = 0.0
    qz: float = 0.0
    qw: float = 1.0


ORIGIN = Pose2D(0.0, 0.0, 0.0)
IDENTITY = Pose3D()
OFF_UNIT = 0.1
"""Difference from length 1 that rounding may give a quaternion."""


def rotate(x: float, y: float, yaw_rad: float) -> tuple[float, float]:
    """Turn a vector on the floor to the left."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return cos * x - sin * y, sin * x + cos * y


def to_map(point: tuple[float, float], pose: Pose2D) -> tuple[float, float]:
    """A point of the frame that stands at `pose`, in the frame that `pose` is given in."""
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    x, y = point
    return pose.x_m + cos * x - sin * y, pose.y_m + sin * x + cos * y


def compose_on_floor(parent: Pose2D, child: Pose2D) -> Pose2D:
    """A pose given in a frame, seen from where that frame's own pose is given; yaws just add up."""
    return Pose2D(*to_map((child.x_m, child.y_m), parent), parent.yaw_rad + child.yaw_rad)


def turn_between(start_rad: float, end_rad: float) -> float:
    """Radians to the left, -pi to pi, from one heading to another: the short way round."""
    return math.remainder(end_rad - start_rad, math.tau)


def distance_on_floor(one: Pose2D, other: Pose2D) -> float:
    """Metres between two poses, whichever way they look."""
    return math.hypot(other.x_m - one.x_m, other.y_m - one.y_m)


def lift(pose: Pose2D) -> Pose3D:
    """The pose in space of a pose on the floor."""
    half = pose.yaw_rad / 2
    return Pose3D(pose.x_m, pose.y_m, 0.0, 0.0, 0.0, math.sin(half), math.cos(half))


def project(pose: Pose3D) -> Pose2D:
    """The pose on the floor below a pose in space, with the direction of its x axis."""
    ahead_x, ahead_y, _ = _rotate(pose, 1.0, 0.0, 0.0)
    return Pose2D(pose.x_m, pose.y_m, math.atan2(ahead_y, ahead_x))


def pitch(down_rad: float) -> Pose3D:
    """A turn about y, which makes a view ahead look down."""
    return Pose3D(qy=math.sin(down_rad / 2), qw=math.cos(down_rad / 2))


def compose(parent: Pose3D, child: Pose3D) -> Pose3D:
    """A pose given in a frame, seen from where that frame's own pose is given."""
    x, y, z = _rotate(parent, child.x_m, child.y_m, child.z_m)
    ax, ay, az, aw = parent.qx, parent.qy, parent.qz, parent.qw
    bx, by, bz, bw = child.qx, child.qy, child.qz, child.qw
    return Pose3D(
        parent.x_m + x,
        parent.y_m + y,
        parent.z_m + z,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(pose: Pose3D) -> Pose3D:
    """The inverse transform: the parent seen from the child."""
    back = Pose3D(0.0, 0.0, 0.0, -pose.qx, -pose.qy, -pose.qz, pose.qw)
    x, y, z = _rotate(back, -pose.x_m, -pose.y_m, -pose.z_m)
    return Pose3D(x, y, z, back.qx, back.qy, back.qz, back.qw)


def distance(one: Pose3D, other: Pose3D) -> float:
    """Metres between two origins."""
    return math.dist((one.x_m, one.y_m, one.z_m), (other.x_m, other.y_m, other.z_m))


def angle(one: Pose3D, other: Pose3D) -> float:
    """Radians that turn one orientation into the other, 0 to pi."""
    dot = one.qx * other.qx + one.qy * other.qy + one.qz * other.qz + one.qw * other.qw
    return 2 * math.acos(min(abs(dot), 1.0))


def unit(pose: Pose3D) -> Pose3D:
    """The pose with a quaternion of length 1; length 0 counts as no rotation."""
    length = math.hypot(pose.qx, pose.qy, pose.qz, pose.qw)
    if length < 1e-9:
        return Pose3D(pose.x_m, pose.y_m, pose.z_m)
    q = (pose.qx / length, pose.qy / length, pose.qz / length, pose.qw / length)
    return Pose3D(pose.x_m, pose.y_m, pose.z_m, *q)


def rigid(pose: Pose3D) -> Pose3D:
    """The pose with a quaternion of length 1; all NaN if its length is off by over `OFF_UNIT`."""
    length = math.hypot(pose.qx, pose.qy, pose.qz, pose.qw)
    return unit(pose) if abs(length - 1.0) <= OFF_UNIT else Pose3D(*(7 * [math.nan]))


def _rotate(pose: Pose3D, x: float, y: float, z: float) -> tuple[float, float, float]:
    tx = 2 * (pose.qy * z - pose.qz * y)
    ty = 2 * (pose.qz * x - pose.qx * z)
    tz = 2 * (pose.qx * y - pose.qy * x)
    return (
        x + pose.qw * tx + pose.qy * tz - pose.qz * ty,
        y + pose.qw * ty + pose.qz * tx - pose.qx * tz,
        z + pose.qw * tz + pose.qx * ty - pose.qy * tx,
    )
