"""Transforms go out on `/tf` and `/tf_static`, names that all robots of a domain share."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from rclpy.node import Node

from edgevox.ros2.messages import transform_msg
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose
from tf2_msgs.msg import TFMessage


class Broadcaster:
    """Publishes what moves."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(TFMessage, "/tf", profile(STANDARD["/tf"].qos))

    def send(self, placed: Sequence[FramePose], stamp: Time) -> None:
        """Where things are at this stamp."""
        if self._publisher.get_subscription_count():
            self._publisher.publish(_message(placed, stamp))


def broadcast_fixed(node: Node, placed: Sequence[FramePose]) -> None:
    """Publish what never moves, for everybody who joins, now and later; call it once."""
    node.create_publisher(TFMessage, "/tf_static", profile(STANDARD["/tf_static"].qos)).publish(
        _message(placed, Time())
    )


def _message(placed: Sequence[FramePose], stamp: Time) -> TFMessage:
    return TFMessage(
        transforms=[transform_msg(one.parent, one.child, one.pose, stamp) for one in placed]
    )
