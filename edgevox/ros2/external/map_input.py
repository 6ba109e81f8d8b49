"""The map of a robot: its newest occupancy grid, kept as it came until somebody looks at it."""

import math
import threading

import numpy as np
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from edgevox.core.errors import InvalidValue
from edgevox.core.frame_names import MAP
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.transforms import project, rigid
from edgevox.robots.occupancy_map import FREE, OCCUPIED, UNKNOWN, OccupancyMap
from edgevox.ros2.external.motion_bounds import FURTHEST_M, on_the_map
from edgevox.ros2.messages import pose_of
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import DRIVEN

log = get_logger(__name__)

TOPIC = "map"
MOST_CELLS = 1 << 24
"""Of a grid that is heard: 200 m by 200 m of 5 cm."""
MOST_SHOWN = 512
"""So many cells along each side are kept of it."""
FREE_PERCENT, OCCUPIED_PERCENT = 25, 65
"""Up to the one a cell is free, from the other on it is occupied, as for Nav2's map server."""
FINEST_M = 0.001
_MOST_BYTES = MOST_CELLS + 4096
_TILTED = 0.1
_KINDS: NDArray[np.uint8] = np.full(256, UNKNOWN, np.uint8)
_KINDS[: FREE_PERCENT + 1] = FREE
_KINDS[OCCUPIED_PERCENT:101] = OCCUPIED


class MapInput:
    """Subscribes on a node in the robot's namespace; thread-safe.

    What comes is only stored, since the thread that hears it steers the robot, too. It is read when
    somebody looks; what cannot be a map is refused then, and the one that was there stays.
    """

    def __init__(self, node: Node) -> None:
        self.topic = node.resolve_topic_name(TOPIC)
        self.refused = 0
        """How many could not be a map."""
        self._unread: bytes | None = None
        self._newest: tuple[OccupancyMap, str] | None = None
        self._lock = threading.Lock()
        quality = profile(DRIVEN[TOPIC].qos)
        node.create_subscription(OccupancyGrid, TOPIC, self._hear, quality, raw=True)

    def newest(self) -> tuple[OccupancyMap, str] | None:
        """The map and the frame that it is in; None before the first. May take long."""
        with self._lock:
            data, self._unread = self._unread, None
            if data is not None:
                self._read(data)
            return self._newest

    def _hear(self, data: bytes) -> None:
        self._unread = data[: _MOST_BYTES + 1]  # of more than is read nothing is kept

    def _read(self, data: bytes) -> None:
        try:
            if len(data) > _MOST_BYTES:
                raise _wrong("data", "more", f"at most {MOST_CELLS} cells")
            message = deserialize_message(data, OccupancyGrid)
            self._newest = map_of(message), message.header.frame_id or MAP
        except (InvalidValue, RuntimeError) as error:  # the latter of bytes that are no message
            self.refused += 1
            if worth_a_line(self.refused):
                log.warning("map_impossible", topic=self.topic, reason=str(error))


def map_of(message: OccupancyGrid) -> OccupancyMap:
    """What is known of it, coarse enough to be shown. Raises `InvalidValue` naming the field."""
    info = message.info
    rows, columns, resolution_m = info.height, info.width, info.resolution
    if not 0 < rows * columns <= MOST_CELLS:
        raise _wrong("info", f"{columns} by {rows} cells", f"1 to {MOST_CELLS} cells")
    if len(message.data) != rows * columns:
        raise _wrong("data", f"{len(message.data)} cells", f"{rows * columns}")
    most_m = 2 * FURTHEST_M / max(rows, columns)
    if not FINEST_M <= resolution_m <= most_m:  # which no NaN is
        raise _wrong("info.resolution", resolution_m, f"{FINEST_M:g} to {most_m:g} m")
    pose = rigid(pose_of(info.origin))
    origin = project(pose)
    if not on_the_map(origin) or math.hypot(pose.qx, pose.qy) > _TILTED:
        raise _wrong("info.origin", pose, "one that lies flat, within the map's bounds")
    cells = _KINDS[np.frombuffer(message.data, np.uint8).reshape(rows, columns)]
    return OccupancyMap(cells, resolution_m, origin).cropped().reduced(MOST_SHOWN)


def _wrong(field: str, value: object, expected: str) -> InvalidValue:
    return InvalidValue(f"{TOPIC}: {field}", value, expected)
