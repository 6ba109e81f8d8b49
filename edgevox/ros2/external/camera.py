"""The robot's camera: raw pictures, or compressed ones.

A picture is kept as it came, since decoding each costs a core.
"""

import io
import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Pillow
from PIL import UnidentifiedImageError
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage, Image

from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.ros2.external.odometry import SILENT_S
from edgevox.ros2.external.topic_types import TopicTypes, listening

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
