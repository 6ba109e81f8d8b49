"""The components' word on `/diagnostics`, as rqt_robot_monitor and the aggregator expect it.

A status is called ``/robot1/edgevox: audio``: the node's full name and the component, as
diagnostic_updater does it with `use_fqn`. The short name, its default, is the same for every robot
of a domain, and whoever listens would take two robots for one.
"""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from edgevox.core.status import Components, Status
from edgevox.ros2.contract import DIAGNOSTICS
from edgevox.ros2.qos import profile
from edgevox.ros2.ticker import Ticker


class DiagnosticsPublisher:
    """Publishes the report of all components, on the ticker: also when the executor hangs."""

    def __init__(self, node: Node, components: Components, ticker: Ticker) -> None:
        self._node = node
        self._components = components
        self._name = str(node.get_fully_qualified_name())
        row = DIAGNOSTICS
        self._publisher = node.create_publisher(DiagnosticArray, row.topic, profile(row.qos))
        self._forget: Callable[[], None] = ticker.every(1.0 / row.rate_hz, self._publish)

    def close(self) -> None:
        """Publish nothing more."""
        self._forget()

    def _publish(self) -> None:
        message = DiagnosticArray()
        message.status = [as_message(self._name, one) for one in self._components.statuses()]
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)


def as_message(node: str, status: Status) -> DiagnosticStatus:
    """A component's status as ROS 2 writes it."""
    return DiagnosticStatus(
        level=bytes([status.level]),
        name=f"{node}: {status.name}",
        message=status.message,
        hardware_id=node,
        values=[KeyValue(key=key, value=value) for key, value in status.texts.items()],
    )
