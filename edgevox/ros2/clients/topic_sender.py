"""Publishes on a topic, to somebody who listens."""

from typing import Any

from rclpy.node import Node

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.ros2.clients.interface_client import InterfaceClient
from edgevox.ros2.qos import interface_profile

STEERING = frozenset({"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"})
"""Velocities have one way, with limits, a watchdog and the policy: that of drives."""


def type_name(kind: Any) -> str:
    """The name of a message's class, such as ``std_msgs/msg/String``."""
    return "/".join((kind.__module__.split(".")[0], "msg", kind.__name__))


class TopicSender(InterfaceClient):
    """A topic's publisher; what is `latched` is kept for who listens later."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock, *, latched: bool) -> None:
        super().__init__(node, kind, name, clock)
        self._latched = latched
        qos = interface_profile(latched=latched, heard=False)
        self._publisher = node.create_publisher(kind, name, qos)

    def until_heard(self, token: CancelToken, timeout_s: float) -> None:
        """Wait until somebody listens, unless it is latched. Raises `SkillFailed`, `Cancelled`."""
        if not self._latched:
            heard = self._publisher.get_subscription_count
            self.until_there(lambda: heard() > 0, token, timeout_s, "nobody_listens")

    def send(self, message: Any) -> None:
        """Publish this."""
        self._publisher.publish(message)
