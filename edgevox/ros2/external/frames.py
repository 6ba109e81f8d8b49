"""Transforms between frames, from /tf and /tf_static: the newest of each, and chains of them.

No times are interpolated: what is asked is where things are now. Frame ids are compared without a
leading slash. No ROS here; a transform is a (4, 4) matrix in metres that takes points of the child
frame to its parent.
"""

import math
import threading
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from edgevox.robots.capabilities import Pose2D
from edgevox.ros2.external.plausible import FURTHEST_FRAME_M
from edgevox.ros2.interop.geometry import OFF_UNIT

MAP = "map"
MOST_FRAMES = 2000

Matrix = NDArray[np.float64]
Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""


class Frames:
    """The tree of frames as last heard. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._parents: dict[str, tuple[str, Matrix]] = {}

    def put(self, parent: str, child: str, transform: Matrix) -> bool:
        """Remember it; False, and forgotten, if it cannot be one."""
        parent, child = plain(parent), plain(child)
        with self._lock:
            known = child in self._parents or len(self._parents) < MOST_FRAMES
            near = (np.abs(transform) <= FURTHEST_FRAME_M).all()  # which no NaN is
            good = parent and child and parent != child and near
            if not (good and known):
                return False
            self._parents[child] = (parent, transform)
            return True

    def knows(self, frame: str) -> bool:
        """Whether a transform has placed this frame."""
        with self._lock:
            return plain(frame) in self._parents

    def lookup(self, target: str, source: str) -> Matrix | None:
        """Takes points of `source` to `target`; None if no chain joins them."""
        with self._lock:
            up = dict(self._climb(plain(source)))
            for frame, from_target in self._climb(plain(target)):
                if frame in up:
                    there: Matrix = np.linalg.inv(from_target) @ up[frame]
                    return there
        return None

    def map_above(self, frame: str) -> str | None:
        """The map that a frame hangs from: itself, or the nearest called ``map`` or ``.../map``."""
        with self._lock:
            return next((f for f, _ in self._climb(plain(frame)) if _basename(f) == MAP), None)

    def _climb(self, frame: str) -> Iterator[tuple[str, Matrix]]:
        """A frame and all above it, each with what takes the first one's points to it."""
        transform: Matrix = np.eye(4)
        seen = {frame}
        yield frame, transform
        while frame in self._parents:
            frame, step = self._parents[frame]
            if frame in seen:
                return
            seen.add(frame)
            transform = step @ transform
            yield frame, transform


def matrix(translation: Vector3, rotation: Quaternion) -> Matrix:
    """A transform of a translation (m) and a quaternion; of NaN if that is not of length 1."""
    x, y, z, w = rotation
    norm = math.hypot(x, y, z, w)
    if not abs(norm - 1.0) <= OFF_UNIT:
        return np.full((4, 4), np.nan)
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    turned: Matrix = np.eye(4)
    turned[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    turned[:3, 3] = translation
    return turned


def flatten(transform: Matrix) -> Pose2D:
    """Where a transform puts its child frame on the floor, and which way that looks."""
    yaw_rad = math.atan2(transform[1, 0], transform[0, 0])
    return Pose2D(float(transform[0, 3]), float(transform[1, 3]), yaw_rad)


def plain(frame: str) -> str:
    """A frame id without the leading slash of old."""
    return frame.removeprefix("/")


def _basename(frame: str) -> str:
    return frame.rpartition("/")[2]
