"""Where the robot's own frames were on the map, for as long as a peer may ask."""

import threading
from bisect import bisect_left
from collections import deque
from collections.abc import Mapping

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import IDENTITY, Pose3D, compose
from edgevox.ros2.interop.broadcast import Link
from edgevox.ros2.interop.frames import Frames

KEPT = 300
"""Poses that are remembered: 10 s at 30 Hz, as tf2 does."""
AHEAD_NS = 500_000_000
"""How far another machine's clock may be ahead of the newest pose."""


class Whereabouts:
    """The last poses of the frames that move, and the places of those that do not."""

    def __init__(self, frames: Frames) -> None:
        self._frames = frames
        self._fixed: dict[str, tuple[str, Pose3D]] = {}
        self._past: deque[tuple[int, Mapping[str, Pose3D]]] = deque(maxlen=KEPT)
        self._lock = threading.Lock()

    def fix(self, links: list[Link]) -> None:
        """These frames never move in their parents; parents first."""
        self._fixed = {child: (parent, pose) for parent, child, pose in links}

    def note(self, stamp_ns: int, poses: Mapping[str, Pose3D]) -> None:
        """Where the moving frames are on the map now."""
        with self._lock:
            if self._past and stamp_ns < self._past[-1][0]:
                self._past.clear()  # time itself was set back
            self._past.append((stamp_ns, poses))

    def on_map(self, frame: str, stamp_ns: int) -> Pose3D:
        """Where a frame was at a stamp; 0 is now. Raises `InvalidValue` if that is not known."""
        if frame == self._frames.map:
            return IDENTITY
        poses = self._at(stamp_ns)
        for name in self._frames.names_of(frame):
            pose = self._find(name, poses)
            if pose is not None:
                return pose
        known = [self._frames.map, *poses, *self._fixed]
        raise InvalidValue("frame_id", frame, "one of " + ", ".join(known))

    def _find(self, name: str, poses: Mapping[str, Pose3D]) -> Pose3D | None:
        if name in self._fixed:
            parent, pose = self._fixed[name]
            above = self._find(parent, poses)
            return None if above is None else compose(above, pose)
        return IDENTITY if name == self._frames.map else poses.get(name)

    def _at(self, stamp_ns: int) -> Mapping[str, Pose3D]:
        with self._lock:
            past = list(self._past)
        if not past or stamp_ns == 0:
            return past[-1][1] if past else {}
        oldest, newest = past[0][0], past[-1][0]
        if not oldest <= stamp_ns <= newest + AHEAD_NS:
            raise InvalidValue(
                "stamp", stamp_ns / 1e9, f"0 for now, or {oldest / 1e9:.3f} to {newest / 1e9:.3f} s"
            )
        after = min(bisect_left(past, stamp_ns, key=lambda one: one[0]), len(past) - 1)
        before = max(after - 1, 0)
        nearest = min(before, after, key=lambda number: abs(past[number][0] - stamp_ns))
        return past[nearest][1]
