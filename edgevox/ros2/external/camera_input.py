"""The camera of a robot: its newest picture, kept as it came, since decoding each costs a core."""

import math

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import Image

from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.ros2.external.odometry_history import SILENT_S
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import DRIVEN

TOPIC = "camera/image_raw"
ENCODINGS = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "8UC3": (3, (2, 1, 0)),
    "mono8": (1, (0, 0, 0)),
    "8UC1": (1, (0, 0, 0)),
}
"""How many bytes a pixel has, and where red, green and blue stand in it."""


class CameraInput:
    """Subscribes on a node in the robot's namespace; thread-safe."""

    def __init__(self, node: Node, clock: Clock) -> None:
        self._clock = clock
        self._newest: tuple[float, bytes] = (-math.inf, b"")
        quality = profile(DRIVEN[TOPIC].qos)
        node.create_subscription(Image, TOPIC, self._hear, quality, raw=True)

    @property
    def sees(self) -> bool:
        """Whether a picture came within the last second."""
        return self._clock.now() - self._newest[0] <= SILENT_S

    def pixels(self) -> NDArray[np.uint8] | None:
        """The newest picture, shape (height, width, 3), RGB; None if none came in the last second.

        Raises `InvalidValue` for one that cannot be shown.
        """
        heard_s, data = self._newest
        if self._clock.now() - heard_s > SILENT_S:
            return None
        return pixels_of(deserialize_message(data, Image))

    def _hear(self, data: bytes) -> None:
        self._newest = (self._clock.now(), data)


def pixels_of(message: Image) -> NDArray[np.uint8]:
    """Its pixels, shape (height, width, 3), RGB. Raises `InvalidValue` naming the field."""
    if message.encoding not in ENCODINGS:
        raise InvalidValue(f"{TOPIC}: encoding", message.encoding, " or ".join(ENCODINGS))
    size, order = ENCODINGS[message.encoding]
    height, width, step = message.height, message.width, message.step
    row = width * size
    if not height or not width or step < row:
        shape = f"{height} rows of {width} in {step} bytes"
        raise InvalidValue(f"{TOPIC}: step", shape, "rows that hold their pixels")
    if len(message.data) != height * step:
        raise InvalidValue(f"{TOPIC}: data", f"{len(message.data)} bytes", f"{height * step}")
    rows = np.frombuffer(message.data, np.uint8).reshape(height, step)[:, :row]
    return np.ascontiguousarray(rows.reshape(height, width, size)[:, :, order])
