"""A 2D lidar by ray casting, all beams against all sides at once in NumPy."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import LidarScan
from edgevox.robots.shapes import Circle, Floats, Shape, edges, place
from edgevox.robots.world_model import Thing, World

_PARALLEL = 1e-12


def cast(
    origin: tuple[float, float], angles_rad: Floats, segments: Floats, discs: Floats
) -> Floats:
    """How far rays go until they hit something, (n,); infinite if they do not.

    `angles_rad` (n,) in the frame of the others; `segments` (m, 4) as x1, y1, x2, y2; `discs`
    (k, 3) as x, y, radius. A ray that starts inside a disc hits its far side.
    """
    rays = np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
    return np.minimum(_to_segments(origin, rays, segments), _to_discs(origin, rays, discs))


class Lidar:
    """The scanner of one world: what stands still is prepared once."""

    def __init__(self, world: World) -> None:
        self._spec = world.robot.lidar
        self._movable = world.movable
        segments, discs = _outlines((t, t.pose) for t in world.fixed)
        self._segments, self._discs = np.vstack([world.border, segments]), discs
        first_rad = -self._spec.angle_range_rad / 2
        numbers = np.arange(self._spec.beams, dtype=np.float64)
        self._angles: Floats = first_rad + self._spec.increment_rad * numbers

    def scan(self, time_s: float, robot: Pose2D, movable: Sequence[Pose2D]) -> LidarScan:
        """One sweep, from where the robot and the movable things are."""
        segments, discs = _outlines(zip(self._movable, movable, strict=True))
        x, y = to_map((self._spec.mount.x_m, self._spec.mount.y_m), robot)
        far = cast(
            (x, y),
            self._angles + robot.yaw_rad + self._spec.mount.yaw_rad,
            np.vstack([self._segments, segments]),
            np.vstack([self._discs, discs]),
        )
        far = np.where(
            far > self._spec.range_max_m, np.inf, np.maximum(far, self._spec.range_min_m)
        )
        return LidarScan(
            time_s=time_s,
            angle_min_rad=-self._spec.angle_range_rad / 2,
            angle_increment_rad=self._spec.increment_rad,
            range_min_m=self._spec.range_min_m,
            range_max_m=self._spec.range_max_m,
            ranges_m=far.astype(np.float32),
            mount=self._spec.mount,
        )


def _outlines(things: Iterable[tuple[Thing, Pose2D]]) -> tuple[Floats, Floats]:
    sides: list[Floats] = [np.empty((0, 4))]
    discs: list[tuple[float, float, float]] = []
    for thing, pose in things:
        for part in thing.parts:
            placed: Shape = place(part, pose)
            if isinstance(placed, Circle):
                discs.append((*placed.center, placed.radius_m))
            else:
                sides.append(edges(placed))
    return np.vstack(sides), np.array(discs, dtype=np.float64).reshape(-1, 3)


def _to_segments(origin: tuple[float, float], rays: Floats, segments: Floats) -> Floats:
    start = segments[:, :2] - origin
    side = segments[:, 2:] - segments[:, :2]
    across = rays[:, :1] * side[:, 1] - rays[:, 1:] * side[:, 0]
    parallel = np.abs(across) < _PARALLEL
    across[parallel] = 1.0
    far = (start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0]) / across
    along = (rays[:, 1:] * start[:, 0] - rays[:, :1] * start[:, 1]) / across
    miss = parallel | (far < 0.0) | (along < 0.0) | (along > 1.0)
    far[miss] = np.inf
    return _nearest(far)


def _to_discs(origin: tuple[float, float], rays: Floats, discs: Floats) -> Floats:
    center = discs[:, :2] - origin
    toward = rays @ center.T
    short = discs[:, 2] ** 2 - (np.sum(center**2, axis=1) - toward**2)
    half = np.sqrt(np.maximum(short, 0.0))
    near, far = toward - half, toward + half
    hit = np.where(near >= 0.0, near, far)
    hit[(short < 0.0) | (far < 0.0)] = np.inf
    return _nearest(hit)


def _nearest(distances: NDArray[np.float64]) -> Floats:
    nearest: Floats = distances.min(axis=1, initial=math.inf)
    return nearest
