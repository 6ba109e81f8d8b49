"""The bridge: an rclpy node that serves the table of `contract`, spun by a thread of its own."""

import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import RobotState
from edgevox.ros2.contract import (
    NODE_NAME,
    PUBLISHED,
    SUBSCRIBED,
    Incoming,
    Published,
    Qos,
    Subscribed,
)

log = logging.getLogger(__name__)


class RosBridgeFailed(EdgeVoxError):
    """ROS 2 is here but cannot be used; the message is its own reason."""


class RosBridge:
    """Publishes the bus on ROS 2 topics and submits what comes in on others.

    `robot_state`, if given, is asked for the body's state `state_hz` times a second. Owns the rclpy
    context, the node, and the thread that spins it.
    """

    def __init__(
        self,
        bus: Bus,
        submit: Callable[[Incoming], None],
        *,
        namespace: str,
        ros_args: Sequence[str] = (),
        robot_state: Callable[[], Mapping[str, Any]] | None = None,
        state_hz: float = 10.0,
    ) -> None:
        self._bus = bus
        self._submit = submit
        self._context = Context()
        self._forget: list[Callable[[], None]] = []
        self._thread = threading.Thread(target=self._spin, name="edgevox-ros2")
        try:
            self._context.init(list(ros_args) or None)
            self._node = Node(NODE_NAME, namespace=namespace, context=self._context)
            self._executor = SingleThreadedExecutor(context=self._context)
        except Exception as error:
            self._context.try_shutdown()
            raise RosBridgeFailed(f"ROS 2 could not be started: {error}") from error
        for published in PUBLISHED:
            if published.event is not RobotState or robot_state:
                self._publish(published)
        for subscribed in SUBSCRIBED:
            self._subscribe(subscribed)
        if robot_state:
            self._node.create_timer(1.0 / state_hz, lambda: bus.publish(RobotState(robot_state())))
        self._executor.add_node(self._node)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Leave the graph: no more messages in or out, the thread joined, shared memory freed."""
        for forget in self._forget:
            forget()
        self._executor.shutdown()
        if self._thread.is_alive():
            self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()

    @property
    def where(self) -> str:
        """The node's full name, for people."""
        return str(self._node.get_fully_qualified_name())

    def _publish(self, row: Published) -> None:
        publisher = self._node.create_publisher(String, row.topic, _profile(row.qos))
        self._forget.append(
            self._bus.subscribe(
                row.event, lambda event: publisher.publish(String(data=row.encode(event)))
            )
        )

    def _subscribe(self, row: Subscribed) -> None:
        self._node.create_subscription(
            String, row.topic, partial(self._receive, row), _profile(row.qos)
        )

    def _receive(self, row: Subscribed, message: String) -> None:
        try:
            self._submit(row.decode(message.data))
        except InvalidValue as error:
            self._node.get_logger().warning(str(error))
        except Exception:
            log.exception("a message on %s failed", row.topic)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            log.debug("the ROS 2 context is gone")


def _profile(qos: Qos) -> QoSProfile:
    spec = qos.value
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=spec.depth,
        reliability=ReliabilityPolicy.RELIABLE if spec.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL if spec.transient_local else DurabilityPolicy.VOLATILE
        ),
    )
