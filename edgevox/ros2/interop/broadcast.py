"""Transforms go out on `/tf` and `/tf_static`, names that all robots of a domain share."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from rclpy.node import Node

from edgevox.ros2.messages import transform_msg
from edgevox.ros2.qos import profile
from edgevox.ros2.stamped_publisher import StampedPublisher
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose
from tf2_msgs.msg import TFMessage


class Broadcaster:
    """Publishes what moves."""

    def __init__(self, node: Node) -> None:
        self._publisher = StampedPublisher(node, TFMessage, "/tf")

    def send(self, placed: Sequence[FramePose], stamp_ns: int) -> None:
        """Where things are at this stamp."""
        self._publisher.say(placed, lambda stamp: _message(placed, stamp), stamp_ns)


def broadcast_fixed(node: Node, placed: Sequence[FramePose]) -> None:
    """Publish what never moves, for everybody who joins, now and later; call it once."""
    node.create_publisher(TFMessage, "/tf_static", profile(STANDARD["/tf_static"].qos)).publish(
        _message(placed, Time())
    )


def _message(placed: Sequence[FramePose], stamp: Time) -> TFMessage:
    return TFMessage(
        transforms=[transform_msg(one.parent, one.child, one.pose, stamp) for one in placed]
    )
