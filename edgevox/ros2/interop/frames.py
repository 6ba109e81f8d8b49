"""The names of the frames, REP 105.

`map` is shared by all robots of a domain, so it has no prefix; every frame that belongs to one
robot has: with ``robot1/``, `robot1/odom`, `robot1/base_link`, and so on. This is what Nav2's
examples of several robots with one map and robot_state_publisher's `frame_prefix` do.
"""

from edgevox.core.errors import InvalidValue
from edgevox.core.frame_names import (
    BASE,
    MAP,
    ODOM_EXPECTED,
    ODOM_FRAMES,
    PREFIX_EXPECTED,
    is_prefix,
)

HAND = "ee_link"
LIDAR = "lidar_link"
CAMERA = "camera_link"
CAMERA_OPTICAL = "camera_optical_frame"
"""Turned as REP 103 wants pictures: z forward, x right, y down."""


class Frames:
    """The full names of one robot's frames.

    `odom` is the name of the odometry frame, or empty if `base_link` hangs on `map` directly.
    Raises `InvalidValue` for a name that tf2 would not take.
    """

    def __init__(self, odom: str = "", prefix: str = "") -> None:
        if odom not in ODOM_FRAMES:
            raise InvalidValue("odom_frame", odom, ODOM_EXPECTED)
        if not is_prefix(prefix):
            raise InvalidValue("frame_prefix", prefix, PREFIX_EXPECTED)
        self.map = MAP
        self.odom = f"{prefix}{odom}" if odom else ""
        self.base = f"{prefix}{BASE}"
        self.hand = f"{prefix}{HAND}"
        self.lidar = f"{prefix}{LIDAR}"
        self.camera = f"{prefix}{CAMERA}"
        self.camera_optical = f"{prefix}{CAMERA_OPTICAL}"
        self._prefix = prefix

    def names_of(self, frame: str) -> tuple[str, ...]:
        """What a peer may have meant by a frame: itself, or this robot's frame of that name."""
        return (frame, f"{self._prefix}{frame}") if frame != MAP else (frame,)
