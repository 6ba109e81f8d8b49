"""Transforms go out on `/tf` and `/tf_static`, names that all robots of a domain share."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from rclpy.node import Node

from edgevox.ros2.interop.tf_encoder import TfEncoder
from edgevox.ros2.messages import transform_msg
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose
from tf2_msgs.msg import TFMessage


class Broadcaster:
    """Publishes what moves."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(TFMessage, "/tf", profile(STANDARD["/tf"].qos))
        self._encoder = TfEncoder(())

    def send(self, placed: Sequence[FramePose], stamp_ns: int) -> None:
        """Where things are at this stamp."""
        if not self._publisher.get_subscription_count():
            return
        if self._encoder.frames != tuple((one.parent, one.child) for one in placed):
            self._encoder = TfEncoder(placed)
        self._publisher.publish(self._encoder.encode(stamp_ns, [one.pose for one in placed]))


def broadcast_fixed(node: Node, placed: Sequence[FramePose]) -> None:
    """Publish what never moves, for everybody who joins, now and later; call it once."""
    transforms = [transform_msg(one.parent, one.child, one.pose, Time()) for one in placed]
    publisher = node.create_publisher(TFMessage, "/tf_static", profile(STANDARD["/tf_static"].qos))
    publisher.publish(TFMessage(transforms=transforms))
