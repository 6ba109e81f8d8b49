"""Transforms between frames, from /tf and /tf_static: the newest of each, and chains of them.

No times are interpolated: what is asked is where things are now. Frame ids are compared without a
leading slash. No ROS here; a transform is the child's pose in its parent.
"""

import threading
from collections.abc import Iterator

from edgevox.core.frame_names import MAP
from edgevox.core.transforms import IDENTITY, Pose3D, compose, inverse
from edgevox.ros2.external.plausible import FURTHEST_FRAME_M

MOST_FRAMES = 2000


class Frames:
    """The tree of frames as last heard. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._parents: dict[str, tuple[str, Pose3D]] = {}

    def put(self, parent: str, child: str, transform: Pose3D) -> bool:
        """Remember where `child` is; False, and forgotten, if it cannot be there."""
        parent, child = plain(parent), plain(child)
        with self._lock:
            known = child in self._parents or len(self._parents) < MOST_FRAMES
            at = transform.x_m, transform.y_m, transform.z_m
            near = all(abs(metres) <= FURTHEST_FRAME_M for metres in at)  # which no NaN is
            good = parent and child and parent != child and near
            if not (good and known):
                return False
            self._parents[child] = (parent, transform)
            return True

    def knows(self, frame: str) -> bool:
        """Whether a transform has placed this frame."""
        with self._lock:
            return plain(frame) in self._parents

    def lookup(self, target: str, source: str) -> Pose3D | None:
        """Where `source` is in `target`; None if no chain joins them."""
        with self._lock:
            up = dict(self._climb(plain(source)))
            for frame, from_target in self._climb(plain(target)):
                if frame in up:
                    return compose(inverse(from_target), up[frame])
        return None

    def map_above(self, frame: str) -> str | None:
        """The map that a frame hangs from: itself, or the nearest called ``map`` or ``.../map``."""
        with self._lock:
            return next((f for f, _ in self._climb(plain(frame)) if _basename(f) == MAP), None)

    def _climb(self, frame: str) -> Iterator[tuple[str, Pose3D]]:
        """A frame and all above it, each with where the first one is in it."""
        transform = IDENTITY
        seen = {frame}
        yield frame, transform
        while frame in self._parents:
            frame, step = self._parents[frame]
            if frame in seen:
                return
            seen.add(frame)
            transform = compose(step, transform)
            yield frame, transform


def plain(frame: str) -> str:
    """A frame id without the leading slash of old."""
    return frame.removeprefix("/")


def _basename(frame: str) -> str:
    return frame.rpartition("/")[2]
