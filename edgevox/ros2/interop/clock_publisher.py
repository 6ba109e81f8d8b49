"""The body's time goes out on `/clock`, for peers with `use_sim_time`."""

from collections.abc import Callable

from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import NS_PER_S, to_msg
from edgevox.ros2.standard_topics import STANDARD


class ClockPublisher:
    """Publishes the body's time whenever it has changed."""

    def __init__(self, node: Node, body_time: Callable[[], float]) -> None:
        self._body_time = body_time
        self._last_ns: int | None = None
        self._publisher = node.create_publisher(Clock, "/clock", profile(STANDARD["/clock"].qos))

    def tick(self) -> None:
        """Look, and say it."""
        now_ns = round(self._body_time() * NS_PER_S)
        if now_ns != self._last_ns:
            self._last_ns = now_ns
            self._publisher.publish(Clock(clock=to_msg(now_ns)))
