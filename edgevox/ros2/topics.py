"""The topics of `contract`: events go out, and what comes in becomes commands."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.events import RobotState
from edgevox.ros2.contract import PUBLISHED, SUBSCRIBED, Incoming, Published, Qos, Subscribed


class Topics:
    """Serves the rows of `PUBLISHED` and `SUBSCRIBED` on a node.

    `robot_state`, if given, is asked for the body's state `state_hz` times a second.
    """

    def __init__(
        self,
        node: Node,
        bus: Bus,
        submit: Callable[[Incoming], None],
        robot_state: Callable[[], Mapping[str, Any]] | None = None,
        state_hz: float = 10.0,
    ) -> None:
        self._node = node
        self._bus = bus
        self._submit = submit
        self._forget: list[Callable[[], None]] = []
        for published in PUBLISHED:
            if published.event is not RobotState or robot_state:
                self._publish(published)
        for subscribed in SUBSCRIBED:
            self._subscribe(subscribed)
        if robot_state:
            node.create_timer(1.0 / state_hz, lambda: bus.publish(RobotState(robot_state())))

    def close(self) -> None:
        """Publish nothing more."""
        for forget in self._forget:
            forget()

    def _publish(self, row: Published) -> None:
        publisher = self._node.create_publisher(String, row.topic, profile(row.qos))
        self._forget.append(
            self._bus.subscribe(
                row.event, lambda event: publisher.publish(String(data=row.encode(event)))
            )
        )

    def _subscribe(self, row: Subscribed) -> None:
        self._node.create_subscription(
            String, row.topic, partial(self._receive, row), profile(row.qos)
        )

    def _receive(self, row: Subscribed, message: String) -> None:
        try:
            self._submit(row.decode(message.data))
        except InvalidValue as error:
            self._node.get_logger().warning(str(error))


def profile(qos: Qos) -> QoSProfile:
    """A quality of service of the contract, as rclpy wants it."""
    spec = qos.value
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=spec.depth,
        reliability=ReliabilityPolicy.RELIABLE if spec.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL if spec.transient_local else DurabilityPolicy.VOLATILE
        ),
    )
