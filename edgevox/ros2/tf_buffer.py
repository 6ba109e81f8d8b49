"""A transform buffer: `/tf` and `/tf_static`, remembered for a while. Does not import ROS.

It serves both sides: the robot's own frames, for peers that ask for a past pose, and the frames of
a robot that is only heard. It works like tf2's, without interpolation: a pose is the remembered one
nearest in time. Frame ids are compared without a leading slash.
"""

import threading
from bisect import bisect_left
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import IDENTITY, MAP, Pose3D, compose, inverse

KEPT = 300
"""Poses of each frame that are remembered: 10 s at 30 Hz, as tf2 does."""
AHEAD_NS = 500_000_000
"""The most by which another machine's clock may be ahead of the newest pose."""
MOST_FRAMES = 2000
FURTHEST_FRAME_M = 1e7
"""Frames may be as far apart as the earth's middle and a map on it (REP 105)."""
NOW = 0
"""The stamp that asks for the newest."""
FOR_GOOD = -1
"""The stamp of a frame that never moves in its parent."""


@dataclass(frozen=True, slots=True)
class FramePose:
    """The pose of a frame in its parent."""

    parent: str
    child: str
    pose: Pose3D


class _Sample(NamedTuple):
    """A remembered pose of a frame in its parent."""

    stamp_ns: int
    parent: str
    pose: Pose3D


class _Climb(NamedTuple):
    """A frame and all frames above it, each with the first frame's pose in it.

    `remembered_ns` is the oldest and newest stamp of the frame at which the climb ended, if its
    parent at the wanted time is not remembered.
    """

    seen_from: Mapping[str, Pose3D]
    remembered_ns: tuple[int, int] | None


class TfBuffer:
    """The last `kept` poses of each frame. Thread-safe."""

    def __init__(self, kept: int = KEPT) -> None:
        self._kept = kept
        self._lock = threading.Lock()
        self._past: dict[str, deque[_Sample]] = {}

    def put(self, stamp_ns: int, *placed: FramePose) -> bool:
        """Remember where frames are at one moment, or `FOR_GOOD`.

        False, and those are forgotten, if any cannot be where it is said to be. A stamp that is
        older than the last one means that time was set back: what is later is forgotten.
        """
        with self._lock:
            taken = [self._put(stamp_ns, one) for one in placed]
        return all(taken)

    @property
    def frames(self) -> tuple[str, ...]:
        """The frames that a transform has placed, those that move first."""
        with self._lock:
            past = self._past
            return tuple(sorted(past, key=lambda one: past[one][-1].stamp_ns == FOR_GOOD))

    def knows(self, frame: str) -> bool:
        """Return whether a transform has placed this frame."""
        with self._lock:
            return plain(frame) in self._past

    def lookup(self, target: str, source: str, stamp_ns: int = NOW) -> Pose3D | None:
        """Return the pose of `source` in `target` at a stamp; None if no chain joins them.

        Raises `InvalidValue` for a stamp that is no longer, or not yet, remembered.
        """
        with self._lock:
            up = self._climb(plain(source), stamp_ns)
            down = self._climb(plain(target), stamp_ns)
        for frame, from_target in down.seen_from.items():
            if frame in up.seen_from:
                return compose(inverse(from_target), up.seen_from[frame])
        if remembered_ns := up.remembered_ns or down.remembered_ns:
            oldest_s, newest_s = (stamp / 1e9 for stamp in remembered_ns)
            expected = f"0 for now, or {oldest_s:.3f} to {newest_s:.3f} s"
            raise InvalidValue("stamp", stamp_ns / 1e9, expected)
        return None

    def map_above(self, frame: str) -> str | None:
        """The map that a frame hangs from: itself, or the nearest called ``map`` or ``.../map``."""
        with self._lock:
            above = self._climb(plain(frame), NOW).seen_from
        return next((name for name in above if name.rpartition("/")[2] == MAP), None)

    def _put(self, stamp_ns: int, placed: FramePose) -> bool:
        parent, child, pose = plain(placed.parent), plain(placed.child), placed.pose
        at = pose.x_m, pose.y_m, pose.z_m
        near = all(abs(metres) <= FURTHEST_FRAME_M for metres in at)  # which no NaN is
        known = child in self._past or len(self._past) < MOST_FRAMES
        if not (parent and child and parent != child and near and known):
            return False
        past = self._past.setdefault(child, deque(maxlen=self._kept))
        newest_ns = past[-1].stamp_ns if past else FOR_GOOD
        if newest_ns == FOR_GOOD or stamp_ns < newest_ns:
            past.clear()
        past.append(_Sample(stamp_ns, parent, pose))
        return True

    def _climb(self, frame: str, stamp_ns: int) -> _Climb:
        pose = IDENTITY
        seen_from = {frame: pose}
        while past := self._past.get(frame):
            step = _nearest(past, stamp_ns)
            if step is None:
                return _Climb(seen_from, (past[0].stamp_ns, past[-1].stamp_ns))
            frame = step.parent
            if frame in seen_from:
                break
            pose = compose(step.pose, pose)
            seen_from[frame] = pose
        return _Climb(seen_from, None)


def plain(frame: str) -> str:
    """A frame id without the leading slash of old."""
    return frame.removeprefix("/")


def _nearest(past: deque[_Sample], stamp_ns: int) -> _Sample | None:
    oldest_ns, newest_ns = past[0].stamp_ns, past[-1].stamp_ns
    if stamp_ns == NOW or newest_ns == FOR_GOOD:
        return past[-1]
    if not oldest_ns <= stamp_ns <= newest_ns + AHEAD_NS:
        return None
    after = min(bisect_left(past, stamp_ns, key=lambda one: one.stamp_ns), len(past) - 1)
    before = max(after - 1, 0)
    return min(past[before], past[after], key=lambda one: abs(one.stamp_ns - stamp_ns))
