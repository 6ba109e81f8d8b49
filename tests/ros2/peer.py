"""A ROS 2 peer that has never heard of EdgeVox: plain rclpy, nothing of edgevox imported."""

import contextlib
import threading
import time
from collections.abc import Callable

from guards import HUNG_S
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
# The publisher keeps one; a subscriber that wants to see every change keeps more.
STATE = QoSProfile(
    depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
DISCOVERY_S = HEARD_S = HUNG_S
"""For what comes, on whatever machine."""


class Heard:
    """The messages of one topic, with a way to wait for one."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.times: list[float] = []
        self._arrived = threading.Condition()

    def add(self, message: String) -> None:
        with self._arrived:
            self.messages.append(message.data)
            self.times.append(time.monotonic())
            self._arrived.notify_all()

    def wait_for(
        self, wanted: Callable[[str], bool], timeout_s: float = HEARD_S, since: int = 0
    ) -> str:
        """The first message from number `since` on that is wanted; fails loudly if none comes."""

        def found() -> list[str]:
            return [m for m in self.messages[since:] if wanted(m)]

        with self._arrived:
            if not self._arrived.wait_for(found, timeout_s):
                raise AssertionError(f"not heard within {timeout_s} s; heard {self.messages[-20:]}")
            return found()[0]


class Peer:
    """A node on a domain, spinning on a thread of its own."""

    def __init__(self, domain: int, namespace: str = "/edgevox") -> None:
        self._namespace = namespace
        self._context = Context()
        self._context.init(domain_id=domain)
        self.node = Node("peer", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers: dict[str, object] = {}
        self._thread = threading.Thread(target=self._spin, name="peer")
        self._thread.start()

    def close(self) -> None:
        if not self._context.ok():
            return
        self._executor.shutdown()
        self._thread.join()
        self.node.destroy_node()
        self._context.try_shutdown()

    def name(self, topic: str) -> str:
        return f"{self._namespace}/{topic}"

    def listen(self, topic: str, qos: QoSProfile = RELIABLE, *, publishers: int = 1) -> Heard:
        """Subscribe, and wait until the publisher, or so many, are matched."""
        heard = Heard()
        subscription = self.node.create_subscription(String, self.name(topic), heard.add, qos)
        wait_until(lambda: subscription.get_publisher_count() >= publishers, topic)
        return heard

    def send(self, topic: str, data: str | bytes, *, subscribers: int = 1) -> None:
        """Publish a string, or the bytes of a serialized message, once so many are matched.

        A subscriber that was there the first time may have left since: that is not waited for.
        """
        known = topic in self._publishers
        if not known:
            publisher = self.node.create_publisher(String, self.name(topic), RELIABLE)
            self._publishers[topic] = publisher
        if not known or subscribers > 1:
            matched = self._publishers[topic].get_subscription_count  # type: ignore[attr-defined]
            wait_until(lambda: matched() >= subscribers, topic)
        message = data if isinstance(data, bytes) else String(data=data)
        self._publishers[topic].publish(message)  # type: ignore[attr-defined]

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            self._executor.spin()


def wait_until(condition: Callable[[], bool], what: str, timeout_s: float = DISCOVERY_S) -> None:
    """Wait for something of the ROS graph, which has no event to wait for."""
    pause = threading.Event()
    deadline = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"{what}: not there within {timeout_s} s")
        pause.wait(0.02)
