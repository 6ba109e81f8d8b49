"""The map of a robot: its newest occupancy grid, checked as it comes, drawn when somebody looks."""

import math
import threading
from collections import deque
from collections.abc import Callable, Mapping

import numpy as np
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from edgevox.core.errors import InvalidValue
from edgevox.core.frame_names import MAP
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.transforms import Pose2D, project, rigid
from edgevox.robots.occupancy_map import FREE, OCCUPIED, UNKNOWN, OccupancyMap
from edgevox.ros2.contract_rows import reliable
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

    What cannot be a map is refused as it comes, and the one that was there stays. Of another the
    cells are looked at when somebody looks, since the thread that hears it steers the robot, too.

    It is asked for both ways: by a publisher that keeps its map for whoever comes later, whom alone
    a subscription that wants such maps hears, and by one that does not.
    """

    def __init__(self, node: Node) -> None:
        self.topic = node.resolve_topic_name(TOPIC)
        self.refused = 0
        """How many could not be a map."""
        self._unread: deque[OccupancyGrid] = deque(maxlen=1)
        self._newest: tuple[OccupancyMap, str] | None = None
        self._lock = threading.Lock()
        self._heard_ns: deque[int] = deque(maxlen=8)
        hear: Callable[..., None] = self._hear  # rclpy's own type knows of no second argument
        for quality in (DRIVEN[TOPIC].qos, reliable(1)):
            node.create_subscription(
                OccupancyGrid,
                TOPIC,
                hear,
                profile(quality),
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                raw=True,
            )

    def newest(self) -> tuple[OccupancyMap, str] | None:
        """The map and the frame that it is in; None before the first. May take long."""
        with self._lock:
            if self._unread:
                message = self._unread.pop()
                self._newest = map_of(message), message.header.frame_id or MAP
            return self._newest

    def _hear(self, data: bytes, info: Mapping[str, int]) -> None:
        sent_ns = info["source_timestamp"]
        if sent_ns in self._heard_ns:  # the other way
            return
        self._heard_ns.append(sent_ns)
        try:
            if len(data) > _MOST_BYTES:
                raise _wrong("data", "more", f"at most {MOST_CELLS} cells")
            message = deserialize_message(data, OccupancyGrid)
            origin_of(message)
        except (InvalidValue, RuntimeError) as error:  # the latter of bytes that are no message
            self.refused += 1
            if worth_a_line(self.refused):
                log.warning("map_impossible", topic=self.topic, reason=str(error))
        else:
            self._unread.append(message)


def map_of(message: OccupancyGrid) -> OccupancyMap:
    """What is known of it, coarse enough to be shown. Raises `InvalidValue` naming the field."""
    origin, info = origin_of(message), message.info
    cells = _KINDS[np.frombuffer(message.data, np.uint8).reshape(info.height, info.width)]
    return OccupancyMap(cells, info.resolution, origin).cropped().reduced(MOST_SHOWN)


def origin_of(message: OccupancyGrid) -> Pose2D:
    """Where its lower left corner is. Raises `InvalidValue` naming the field of what is no map."""
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
    return origin


def _wrong(field: str, value: object, expected: str) -> InvalidValue:
    return InvalidValue(f"{TOPIC}: {field}", value, expected)
