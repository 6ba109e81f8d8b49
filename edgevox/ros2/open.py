"""Opens the bridge, or what stands in for it where there is no ROS 2."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol

from edgevox.core.errors import EdgeVoxError
from edgevox.core.status import Component
from edgevox.ros2.bridge_context import BridgeContext, ExecutorComponent, ExecutorCounts

if TYPE_CHECKING:
    from edgevox.ros2.clients.agent_node_handle import AgentNodeHandle


class Bridge(Protocol):
    """A bridge as an app uses it."""

    @property
    def where(self) -> str:
        """The bridge's address, for people."""

    @property
    def components(self) -> Sequence[Component]:
        """The components that report their status."""

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of refused messages, by topic and reason."""

    def start(self) -> None: ...

    def close(self) -> None: ...


class NullBridge:
    """Stands in where rclpy cannot be imported: does nothing, and says so in `where`."""

    missing = "rclpy cannot be imported"
    where = f"off, since {missing}"
    refusals: Mapping[tuple[str, ...], int] = MappingProxyType({})

    components: Sequence[Component] = (ExecutorComponent(ExecutorCounts, missing),)

    def start(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


def open_bridge(context: BridgeContext, ros_args: Sequence[str] = ()) -> Bridge:
    """A bridge on real ROS 2, or a `NullBridge` where rclpy cannot be imported.

    Raises `EdgeVoxError` where rclpy is here but does not work: no robot is silent in secret.
    """
    try:
        from edgevox.ros2.bridge import RosBridge
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing == "rclpy":
            return NullBridge()
        raise EdgeVoxError(
            f"ROS 2 is here, but {missing} is not: got no module, expected it from an installed"
            " ROS 2 Jazzy or from make msgs"
        ) from error
    return RosBridge(context, ros_args)


def open_node_handle() -> "AgentNodeHandle | None":
    """Open the handle that lends a bridge's node to skills; None if rclpy cannot be imported."""
    try:
        from edgevox.ros2.clients.agent_node_handle import AgentNodeHandle
    except ModuleNotFoundError:
        return None
    return AgentNodeHandle()


def split_ros_args(argv: Sequence[str]) -> tuple[list[str], list[str]]:
    """Our own arguments and ROS 2's: each ``--ros-args`` begins some, up to ``--`` or the end."""
    own: list[str] = []
    ros: list[str] = []
    inside = False
    for argument in argv:
        if argument == "--ros-args":
            inside = True
            ros.append(argument)
        elif inside:
            ros.append(argument)
            inside = argument != "--"
        else:
            own.append(argument)
    return own, ros
