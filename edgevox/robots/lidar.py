"""What a lidar shows of the way straight ahead of a robot, or straight behind it."""

import math

import numpy as np
from numpy.typing import NDArray

from edgevox.robots.capabilities import LidarScan

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
