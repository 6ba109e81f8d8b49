"""The bridge: the node with all of its parts."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from edgevox.core.bus import Bus
from edgevox.ros2.contract import Incoming
from edgevox.ros2.node import RosNode
from edgevox.ros2.topics import Topics


class RosBridge:
    """EdgeVox as a ROS 2 node: what `contract` promises, served until `close`."""

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
        self._node = RosNode(namespace, ros_args)
        self._parts = [Topics(self._node.node, bus, submit, robot_state, state_hz)]

    def start(self) -> None:
        self._node.start()

    def close(self) -> None:
        """No more messages in or out, and nothing left behind."""
        for part in self._parts:
            part.close()
        self._node.close()

    @property
    def where(self) -> str:
        """The node's full name, for people."""
        return self._node.name
