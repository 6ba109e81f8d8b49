"""A point cloud of the robot as a sweep of a lidar: what stands in its way, at any height.

Points on the floor and above the robot are no obstacles. A direction in which the cloud has no
point is not seen: a depth camera looks only ahead.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose3D, compose
from edgevox.robots.capabilities import LidarScan
from edgevox.ros2.stamps import NS_PER_S, to_ns

LOWEST_M, HIGHEST_M = 0.1, 2.0
"""Heights over the robot's base between which a point stands in its way."""
FURTHEST_M = 100.0
BEAMS = 360
MOST_BYTES = 1 << 26
_AXES = ("x", "y", "z")
_FORMATS: Mapping[int, str] = MappingProxyType({PointField.FLOAT32: "f4", PointField.FLOAT64: "f8"})


def points_of(message: PointCloud2) -> NDArray[np.float64]:
    """Return the points, (n, 3) metres, in the cloud's frame. Raises `InvalidValue`."""
    fields = {one.name: one for one in message.fields}
    formats = [_FORMATS.get(fields[axis].datatype) if axis in fields else None for axis in _AXES]
    if None in formats:
        named = ", ".join(fields) or "none"
        raise InvalidValue("fields", named, "x, y and z as floating-point numbers")
    order = ">" if message.is_bigendian else "<"
    step, size = message.point_step, len(message.data)
    offsets = [fields[axis].offset for axis in _AXES]
    try:
        layout = np.dtype(
            {
                "names": _AXES,
                "formats": [f"{order}{one}" for one in formats],
                "offsets": offsets,
                "itemsize": step,
            }
        )
        width, rows, row_step = message.width, message.height, message.row_step or step
        if rows > 1 and row_step != width * step:
            data = np.frombuffer(message.data, np.uint8).reshape(rows, row_step)
            table = np.ascontiguousarray(data[:, : width * step]).view(layout).ravel()
        else:
            table = np.frombuffer(message.data, layout)
    except ValueError as error:
        raise InvalidValue("data", f"{size} bytes", f"points of {step} bytes") from error
    return np.stack([table[axis].astype(np.float64) for axis in _AXES], axis=1)


def scan_of(message: PointCloud2, mount: Pose3D, nearest_m: float) -> LidarScan:
    """Return the sweep round the robot's middle, which has the cloud's frame at `mount`.

    Points nearer than `nearest_m` are the robot itself. Raises `InvalidValue` naming the field.
    """
    points = points_of(message)
    points = _in_parent(mount, points[np.isfinite(points).all(axis=1)])
    far = np.hypot(points[:, 0], points[:, 1])
    width = math.tau / BEAMS
    beams = ((np.arctan2(points[:, 1], points[:, 0]) + math.pi) / width).astype(int) % BEAMS
    ranges = np.full(BEAMS, np.nan, np.float32)
    ranges[beams] = np.inf  # seen, whatever its height
    solid = (points[:, 2] > LOWEST_M) & (points[:, 2] < HIGHEST_M) & (far >= nearest_m)
    nearest = np.full(BEAMS, np.inf)
    np.minimum.at(nearest, beams[solid], far[solid])
    hit = np.isfinite(nearest) & (nearest <= FURTHEST_M)
    ranges[hit] = nearest[hit]
    return LidarScan(
        time_s=to_ns(message.header.stamp) / NS_PER_S,
        angle_min_rad=width / 2 - math.pi,
        angle_increment_rad=width,
        range_min_m=nearest_m,
        range_max_m=FURTHEST_M,
        ranges_m=ranges,
    )


def _in_parent(mount: Pose3D, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points, (n, 3) metres, given in the frame at `mount`, seen from that frame's parent."""
    origin = np.array([mount.x_m, mount.y_m, mount.z_m])
    ends = (compose(mount, Pose3D(*axis)) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    axes = np.array([(one.x_m, one.y_m, one.z_m) for one in ends]) - origin
    moved: NDArray[np.float64] = points @ axes + origin
    return moved
