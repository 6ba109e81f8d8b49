"""A body on ROS 2 without a conversation, and a subscriber for messages of every type."""

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import pytest
from geometry_msgs.msg import Twist
from held_ticks import HeldTime
from peer import RELIABLE, Peer
from rclpy.subscription import Subscription
from waiting import Heard, wait_until

from edgevox.core.motion.interlock import Interlock
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.interop import Interop
from edgevox.ros2.node import RosNode
from edgevox.ros2.ticker import MakeTicker, Ticker

HALL = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 2, 0.5]
  vel_max: [0.8, 2.0]
"""


JITTER = 0.05


class Offered:
    """A body with its interop on a node, and the skills that were asked for.

    With a held `time` what comes at a rate comes as far as the test lets that time pass. `live` are
    all that are on ROS 2 in this process.
    """

    live: ClassVar[list["Offered"]] = []

    def __init__(
        self, body: Any, ros_args: tuple[str, ...], time: HeldTime | None = None, **options: Any
    ) -> None:
        tickers: MakeTicker = time.ticker if time else Ticker
        interlock = options.pop("interlock", None) or Interlock()
        self.body = body
        self.asked = Messages()
        self.ros = RosNode("/edgevox", ros_args)
        self.ticker = tickers("edgevox-ticker")
        self.interop = Interop(
            self.ros.node,
            body,
            lambda name, arguments, _: self.asked.add((name, arguments)),
            self.ticker,
            Backlog(self.ros.node, interlock),
            tickers=tickers,
            interlock=interlock,
            **options,
        )
        body.start()
        self.ros.start()
        self.ticker.start()
        self.live.append(self)

    def listens(self, topic: str) -> bool:
        """Whether it has a subscription there."""
        return bool(self._subscriptions(topic))

    def publishers(self, topic: str) -> int:
        """How many publishers its subscriptions there are matched with: those that it can hear."""
        return sum(one.get_publisher_count() for one in self._subscriptions(topic))

    def _subscriptions(self, topic: str) -> list[Subscription]:
        return [one for one in self.ros.node.subscriptions if one.topic_name == topic]

    def close(self) -> None:
        self.live.remove(self)
        self.interop.close()
        self.ticker.close()
        self.ros.close()
        self.body.close()


class Messages(Heard[Any]):
    """Whole messages, not only their strings; `sent_ns` is when each was sent, by the clock."""

    def __init__(self) -> None:
        super().__init__()
        self.sent_ns: list[int] = []

    def take(self, message: Any, info: Mapping[str, int]) -> None:
        """What a subscription calls: rclpy counts the arguments that have no default."""
        self.sent_ns.append(info["source_timestamp"])
        self.add(message)

    def wait_for_more(self, number: int) -> "Messages":
        """Until so many have come from now on."""
        enough = len(self.messages) + number
        self.wait_until(lambda: len(self.messages) >= enough)
        return self

    def never_faster_than(self, rate_hz: float) -> bool:
        """Whether those that were heard were sent at this rate at most, however late each was.

        One that was late is followed by the next when that is due, so it may be nearer than a
        period, and only that one: what was missed is not made up for.
        """
        periods = len(self.sent_ns) - 2
        assert periods > 2, "too few to tell"
        return (self.sent_ns[-1] - self.sent_ns[0]) / 1e9 > (1 - JITTER) * periods / rate_hz


def hear(peer: Peer, kind: type, topic: str, qos: Any = RELIABLE) -> Messages:
    """Subscribe to an absolute name, and wait until somebody publishes there."""
    heard = Messages()
    peer.node.create_subscription(kind, topic, heard.take, qos)
    wait_until(lambda: peer.node.count_publishers(topic) > 0, topic)
    return heard


def tell(
    peer: Peer, kind: type, topic: str, qos: Any = RELIABLE, *, subscribers: int = 1
) -> Callable[[Any], None]:
    """A way to publish there, once so many listen.

    Those of this process have matched it too: a publisher that knows its listener may still not be
    known to it, and the first message is lost then.
    """
    known = {one: one.publishers(topic) for one in Offered.live}
    publisher = peer.node.create_publisher(kind, topic, qos)
    wait_until(lambda: publisher.get_subscription_count() >= subscribers, topic)
    listeners = [one for one in known if one.listens(topic)]
    wait_until(lambda: all(one.publishers(topic) > known[one] for one in listeners), topic)
    return publisher.publish


class Stream:
    """Publishes one message at once, and again and again until it is ended."""

    def __init__(self, say: Callable[[Any], None], message: Any, hertz: float = 20.0) -> None:
        self._ending = threading.Event()

        def work() -> None:
            while not self._ending.wait(1.0 / hertz):
                say(message)

        say(message)
        self._thread = threading.Thread(target=work, name="stream")
        self._thread.start()

    def end(self) -> float:
        """Stop; when that was."""
        self._ending.set()
        self._thread.join()
        return time.monotonic()


def seconds(stamp: Any) -> float:
    """What a stamp of a message says."""
    return float(stamp.sec + stamp.nanosec * 1e-9)


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
