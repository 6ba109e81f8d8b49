"""The lidar's sweeps go out on `scan`."""

from array import array

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

from edgevox.core.transforms import lift
from edgevox.robots.capabilities import HasLidar
from edgevox.ros2.interop.frames import Frames
from edgevox.ros2.messages import header
from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import Stamps, to_msg
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose


class Scanner:
    """Publishes a sweep per tick, every `period_s`, in the lidar's own frame."""

    def __init__(
        self, node: Node, body: HasLidar, frames: Frames, stamps: Stamps, period_s: float
    ) -> None:
        self._body, self._frames, self._stamps = body, frames, stamps
        self._period_s = period_s
        self._publisher = node.create_publisher(LaserScan, "scan", profile(STANDARD["scan"].qos))

    def links(self) -> list[FramePose]:
        """Where the lidar sits on the body."""
        return [FramePose(self._frames.base, self._frames.lidar, lift(self._body.scan().mount))]

    def tick(self) -> None:
        """Sweep, if anybody looks."""
        if not self._publisher.get_subscription_count():
            return
        scan = self._body.scan()
        stamp_ns = self._stamps.nanoseconds(scan.time_s)
        if stamp_ns is None:
            return
        ranges = array("f")
        ranges.frombytes(np.ascontiguousarray(scan.ranges_m, dtype=np.float32).tobytes())
        last = max(len(ranges) - 1, 0)
        self._publisher.publish(
            LaserScan(
                header=header(self._frames.lidar, to_msg(stamp_ns)),
                angle_min=scan.angle_min_rad,
                angle_max=scan.angle_min_rad + last * scan.angle_increment_rad,
                angle_increment=scan.angle_increment_rad,
                time_increment=0.0,  # all beams at one moment
                scan_time=self._period_s,
                range_min=scan.range_min_m,
                range_max=scan.range_max_m,
                ranges=ranges,
            )
        )
