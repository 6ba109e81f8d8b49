"""What is said again goes out as it was serialised, with its new stamp and nothing else new."""

from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.serialization import deserialize_message, serialize_message

from edgevox.core.transforms import Pose3D
from edgevox.ros2.messages import header, pose_msg, transform_msg
from edgevox.ros2.stamps import SerializedMessage, StampedPublisher, to_msg
from tf2_msgs.msg import TFMessage

HERE, THERE = Pose3D(1.0, -2.0, qz=0.6, qw=0.8), Pose3D(3.0, 4.0)
SINCE_NS, LATER_NS = 1_795_000_000_123_456_789, 1_795_000_001_000_000_001


class PoseTopic:
    """A node, and the one topic that it has: what was published on it, as a peer reads it."""

    def __init__(self, listeners: int = 1) -> None:
        self.listeners = listeners
        self.heard: list[PoseStamped] = []
        self.serialized = 0

    def create_publisher(self, *_: object) -> "PoseTopic":
        return self

    def get_subscription_count(self) -> int:
        return self.listeners

    def publish(self, message: Any) -> None:
        ready = isinstance(message, bytes)
        self.serialized += ready
        told = message if ready else serialize_message(message)
        self.heard.append(deserialize_message(told, PoseStamped))


def pose_stamped(pose: Pose3D, stamp_ns: int) -> PoseStamped:
    return PoseStamped(header=header("map", to_msg(stamp_ns)), pose=pose_msg(pose))


def say(publisher: StampedPublisher, pose: Pose3D, stamp_ns: int) -> None:
    publisher.say(
        pose, lambda s: PoseStamped(header=header("map", s), pose=pose_msg(pose)), stamp_ns
    )


@pytest.mark.parametrize("child", ["a", "ab", "abc", "abcd", "robot1/base_link"])
def test_every_stamp_of_a_serialised_message_is_set_and_nothing_else(child: str) -> None:
    def make(stamp: Any) -> TFMessage:
        return TFMessage(
            transforms=[
                transform_msg("map", child, HERE, stamp),
                transform_msg(child, "base_link", THERE, stamp),
            ]
        )

    message = SerializedMessage(make)
    for stamp_ns in (SINCE_NS, LATER_NS, 0):
        told = deserialize_message(message.at(stamp_ns), TFMessage)
        assert told == make(to_msg(stamp_ns))


def test_a_robot_that_stands_and_drives_on_is_said_to_be_where_it_is() -> None:
    topic = PoseTopic()
    publisher = StampedPublisher(topic, PoseStamped, "pose")  # type: ignore[arg-type]
    way = [HERE, HERE, HERE, THERE, THERE, HERE]

    for number, pose in enumerate(way):
        say(publisher, pose, SINCE_NS + number)

    assert topic.heard == [pose_stamped(pose, SINCE_NS + n) for n, pose in enumerate(way)]
    assert topic.serialized == 3, "what was said before is serialised only once"


def test_nothing_is_made_while_nobody_listens() -> None:
    topic = PoseTopic(listeners=0)
    publisher = StampedPublisher(topic, PoseStamped, "pose")  # type: ignore[arg-type]

    for number in range(3):
        publisher.say(HERE, lambda _: pytest.fail("a message was made"), SINCE_NS + number)

    assert not topic.heard
