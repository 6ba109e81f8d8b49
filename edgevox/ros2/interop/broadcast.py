"""Transforms go out on `/tf` and `/tf_static`, names that all robots of a domain share."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from rclpy.node import Node

from edgevox.core.transforms import Pose3D
from edgevox.ros2.messages import transform_msg
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import STANDARD
from tf2_msgs.msg import TFMessage

Link = tuple[str, str, Pose3D]
"""Parent, child, and where the child is in the parent."""


class Broadcaster:
    """Publishes what moves."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(TFMessage, "/tf", profile(STANDARD["/tf"].qos))

    def send(self, links: Sequence[Link], stamp: Time) -> None:
        """Where things are at this stamp."""
        if self._publisher.get_subscription_count():
            self._publisher.publish(_message(links, stamp))


def broadcast_fixed(node: Node, links: Sequence[Link]) -> None:
    """Publish what never moves, for everybody who joins, now and later; call it once."""
    node.create_publisher(TFMessage, "/tf_static", profile(STANDARD["/tf_static"].qos)).publish(
        _message(links, Time())
    )


def _message(links: Sequence[Link], stamp: Time) -> TFMessage:
    return TFMessage(
        transforms=[transform_msg(parent, child, pose, stamp) for parent, child, pose in links]
    )
