"""A ROS 2 peer that has never heard of EdgeVox: plain rclpy, nothing of edgevox imported."""

import contextlib
import threading
from collections.abc import Callable
from typing import Any

from guards import HUNG_S
from rcl_interfaces.srv import ListParameters
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from waiting import Heard, wait_until

RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
# The publisher keeps one; a subscriber that wants to see every change keeps more.
STATE = QoSProfile(
    depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
NAMELESS = "_NODE_NAME_UNKNOWN_"
"""What the graph says of an endpoint until its node's name has come, too."""
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)


def done(future: Any, timeout_s: float = HUNG_S) -> Any:
    """What a future holds, once another thread has filled it."""
    filled = threading.Event()
    future.add_done_callback(lambda _: filled.set())
    assert filled.wait(timeout_s), "no answer came"
    return future.result()


class Peer:
    """A node on a domain, spinning on a thread of its own. `args` are ROS 2's."""

    def __init__(
        self, domain: int, namespace: str = "/edgevox", *, name: str = "peer", args: Any = None
    ) -> None:
        self._namespace = namespace
        self._context = Context()
        self._context.init(args=args, domain_id=domain)
        self.node = Node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers: dict[str, object] = {}
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="peer")
        self._thread.start()

    def close(self) -> None:
        if not self._context.ok():
            return
        # The thread first: what shutdown frees, a callback may be about to use.
        self._closing.set()
        self._executor.create_task(lambda: None)
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()

    def there(self, work: Callable[[], Any]) -> Any:
        """Do it on the executor's thread, which is then doing nothing else; what it returns.

        An action's client or server must be destroyed so: the executor may be taking something for
        it just now, and rclpy does not expect it to be gone.
        """
        return done(self._executor.create_task(work))

    def catch_up(self) -> None:
        """Take all that has come: an executor takes one message a round, however many wait."""
        self.there(self._take_all)

    def _take_all(self) -> None:
        for subscription in self.node.subscriptions:
            while True:
                with subscription.handle:
                    taken = subscription.handle.take_message(
                        subscription.msg_type, subscription.raw
                    )
                if taken is None:
                    break
                subscription.callback(taken[0])

    def name(self, topic: str) -> str:
        return f"{self._namespace}/{topic}"

    def listen(self, topic: str, qos: QoSProfile = RELIABLE, *, publishers: int = 1) -> Heard[str]:
        """Subscribe, and wait until the publisher, or so many, are matched."""
        heard = Heard[str]()
        subscription = self.node.create_subscription(
            String, self.name(topic), lambda message: heard.add(message.data), qos
        )
        wait_until(lambda: subscription.get_publisher_count() >= publishers, topic)
        if qos.durability is not DurabilityPolicy.TRANSIENT_LOCAL:
            self._wait_until_known(self.name(topic))
        return heard

    def _wait_until_known(self, topic: str) -> None:
        """Wait until the publishers know the last subscription, too: what they sent before is lost.

        This side's match says nothing of theirs. But a participant's endpoints are made known in
        their order, and a service answers only who is known to it: so one is asked now.
        """
        publishers = self.node.get_publishers_info_by_topic
        wait_until(
            lambda: all(one.node_name != NAMELESS for one in publishers(topic)), "nodes' names"
        )
        for publisher in publishers(topic):
            name = f"{publisher.node_namespace.rstrip('/')}/{publisher.node_name}/list_parameters"
            services = dict(self.node.get_service_names_and_types())
            if name in services:
                self.call(ListParameters, name, ListParameters.Request())

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

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """The answer of a service, once it is there."""
        client = self.node.create_client(kind, service)
        wait_until(client.service_is_ready, service)
        future = client.call_async(request)
        wait_until(future.done, f"an answer of {service}")
        self.node.destroy_client(client)
        return future.result()

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            while not self._closing.is_set():
                self._executor.spin_once(timeout_sec=1.0)  # a wake-up may be lost
