"""What the robot's camera and depth camera send: pictures, and what stands in its way.

A picture, raw or compressed, is kept as it came, since decoding each costs a core. A point cloud
becomes a sweep of a lidar with what stands in the robot's way, at any height. Points on the floor
and above the robot are no obstacles. A direction in which the cloud has no point is not seen: a
depth camera looks only ahead.
"""

import io
import math
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Pillow
from PIL import UnidentifiedImageError
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage, Image, PointCloud2, PointField

from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose3D, compose
from edgevox.robots.capabilities import LidarScan
from edgevox.ros2.external.odometry import SILENT_S
from edgevox.ros2.external.topic_types import TopicTypes, listening
from edgevox.ros2.stamps import NS_PER_S, to_ns

CAMERA_TOPIC = "camera/image_raw"
ENCODINGS = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "8UC3": (3, (2, 1, 0)),
    "mono8": (1, (0, 0, 0)),
    "8UC1": (1, (0, 0, 0)),
}
"""Bytes per pixel, and the positions of red, green and blue in it, by encoding."""
COMPRESSED = ("JPEG", "PNG", "WEBP")
"""Formats of compressed pictures; depth images are none of them."""
MOST_PIXELS = 1 << 24


class CameraInput:
    """Subscribes on a node in the robot's namespace; thread-safe."""

    def __init__(self, node: Node, clock: Clock, types: TopicTypes) -> None:
        self._clock = clock
        self._newest: tuple[float, type[Any], bytes] = (-math.inf, Image, b"")
        kinds = (Image, CompressedImage)
        hear = {kind: partial(self._hear, kind) for kind in kinds}
        types.follow(CAMERA_TOPIC, listening(node, CAMERA_TOPIC, hear, raw=True))

    @property
    def sees(self) -> bool:
        """Whether a picture came within the last second."""
        return self._clock.now() - self._newest[0] <= SILENT_S

    def pixels(self) -> NDArray[np.uint8] | None:
        """Return the newest picture, shape (height, width, 3), RGB.

        None if none came in the last second. Raises `InvalidValue` for a picture that cannot be
        shown.
        """
        heard_s, kind, data = self._newest
        if self._clock.now() - heard_s > SILENT_S:
            return None
        message = deserialize_message(data, kind)
        return unpacked(message) if kind is CompressedImage else pixels_of(message)

    def _hear(self, kind: type[Any], data: bytes) -> None:
        self._newest = (self._clock.now(), kind, data)


def pixels_of(message: Image) -> NDArray[np.uint8]:
    """Decode the pixels, shape (height, width, 3), RGB. Raises `InvalidValue` naming the field."""
    if message.encoding not in ENCODINGS:
        raise InvalidValue(f"{CAMERA_TOPIC}: encoding", message.encoding, " or ".join(ENCODINGS))
    size, order = ENCODINGS[message.encoding]
    height, width, step = message.height, message.width, message.step
    row = width * size
    if not height or not width or step < row:
        shape = f"{height} rows of {width} in {step} bytes"
        raise InvalidValue(f"{CAMERA_TOPIC}: step", shape, "rows that hold their pixels")
    if len(message.data) != height * step:
        got = f"{len(message.data)} bytes"
        raise InvalidValue(f"{CAMERA_TOPIC}: data", got, f"{height * step}")
    rows = np.frombuffer(message.data, np.uint8).reshape(height, step)[:, :row]
    return np.ascontiguousarray(rows.reshape(height, width, size)[:, :, order])


def unpacked(message: CompressedImage) -> NDArray[np.uint8]:
    """Decode a compressed picture as `pixels_of`. Raises `InvalidValue` naming the field."""
    try:
        picture = Pillow.open(io.BytesIO(message.data), formats=COMPRESSED)
        width, height = picture.size
        if width * height > MOST_PIXELS:
            size = f"{width} by {height} pixels"
            raise InvalidValue(f"{CAMERA_TOPIC}: data", size, f"at most {MOST_PIXELS} pixels")
        return np.asarray(picture.convert("RGB"))
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError) as error:
        expected = f"a picture in {' or '.join(COMPRESSED)}"
        raise InvalidValue(f"{CAMERA_TOPIC}: format", message.format, expected) from error


LOWEST_M, HIGHEST_M = 0.1, 2.0
"""Heights over the robot's base between which a point stands in its way."""
FURTHEST_M = 100.0
BEAMS = 360
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
