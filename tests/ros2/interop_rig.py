"""A body on ROS 2 without a conversation, and ears for messages of every type."""

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from peer import RELIABLE, Heard, Peer, wait_until

from edgevox.robots.apartment import ApartmentRobot
from edgevox.ros2.interop import Interop
from edgevox.ros2.node import RosNode
from edgevox.ros2.ticker import Ticker

HALL = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 2, 0.5]
  vel_max: [0.8, 2.0]
"""


class Offered:
    """A body with its interop on a node, and the skills that were asked for."""

    def __init__(self, body: Any, ros_args: tuple[str, ...], **options: Any) -> None:
        self.body = body
        self.asked = Messages()
        self.ros = RosNode("/edgevox", ros_args)
        self.ticker = Ticker("edgevox-ticker")
        self.interop = Interop(
            self.ros.node, body, lambda *asked: self.asked.add(asked), self.ticker, **options
        )
        body.start()
        self.ros.start()
        self.ticker.start()

    def close(self) -> None:
        self.interop.close()
        self.ticker.close()
        self.ros.close()
        self.body.close()


class Messages(Heard):
    """Whole messages, not only their strings."""

    def add(self, message: Any) -> None:
        with self._arrived:
            self.messages.append(message)
            self.times.append(time.monotonic())
            self._arrived.notify_all()

    def wait_for_seconds(self, seconds: float) -> "Messages":
        """Until messages have come for so long."""
        last = self.times[-1] + seconds if self.times else None

        def long_enough() -> bool:
            nonlocal last
            if last is None and self.times:
                last = self.times[0] + seconds
            return last is not None and self.times[-1] >= last

        with self._arrived:
            assert self._arrived.wait_for(long_enough, seconds + 20.0), len(self.messages)
        return self

    @property
    def hertz(self) -> float:
        return (len(self.times) - 1) / (self.times[-1] - self.times[0])


def hear(peer: Peer, kind: type, topic: str, qos: Any = RELIABLE) -> Messages:
    """Subscribe to an absolute name, and wait until somebody publishes there."""
    heard = Messages()
    peer.node.create_subscription(kind, topic, heard.add, qos)
    wait_until(lambda: peer.node.count_publishers(topic) > 0, topic)
    return heard


def tell(
    peer: Peer, kind: type, topic: str, qos: Any = RELIABLE, *, subscribers: int = 1
) -> Callable[[Any], None]:
    """A way to publish there, once so many listen."""
    publisher = peer.node.create_publisher(kind, topic, qos)
    wait_until(lambda: publisher.get_subscription_count() >= subscribers, topic)
    return publisher.publish


class Stream:
    """Publishes one message again and again, until it is ended."""

    def __init__(self, say: Callable[[Any], None], message: Any, hertz: float = 20.0) -> None:
        self._ending = threading.Event()

        def work() -> None:
            while not self._ending.wait(1.0 / hertz):
                say(message)

        self._thread = threading.Thread(target=work, name="stream")
        self._thread.start()

    def end(self) -> float:
        """Stop; when that was."""
        self._ending.set()
        self._thread.join()
        return time.monotonic()


def twist(linear: float, angular: float) -> Twist:
    """Forward and around."""
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


@pytest.fixture
def offer(domain, monkeypatch):
    """Puts a body on ROS 2, by default the one in the apartment."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    offered: list[Offered] = []

    def start(body: Any = None, ros_args: tuple[str, ...] = (), **options: Any) -> Offered:
        offered.append(Offered(body or ApartmentRobot(), ros_args, **options))
        return offered[-1]

    yield start
    for one in offered:
        one.close()
