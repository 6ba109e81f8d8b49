"""Opens the bridge, or its null twin where there is no ROS 2."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from edgevox.core.bus import Bus
from edgevox.ros2.contract import Incoming


class Bridge(Protocol):
    """What an app does with a bridge."""

    @property
    def where(self) -> str:
        """Where to find it, for people."""

    def start(self) -> None: ...

    def close(self) -> None: ...


class NullBridge:
    """Stands in where rclpy cannot be imported: does nothing, and says so in `where`."""

    where = "off, since rclpy cannot be imported"

    def start(self) -> None:
        """There is nothing to start."""

    def close(self) -> None:
        """There is nothing to close."""


def open_bridge(
    bus: Bus,
    submit: Callable[[Incoming], None],
    *,
    namespace: str,
    ros_args: Sequence[str] = (),
    robot_state: Callable[[], Mapping[str, Any]] | None = None,
    state_hz: float = 10.0,
) -> Bridge:
    """A bridge on real ROS 2, or a `NullBridge` where rclpy cannot be imported.

    Raises `RosBridgeFailed` where rclpy is here but does not work: no robot is silent in secret.
    """
    try:
        from edgevox.ros2.bridge import RosBridge
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "rclpy":
            raise
        return NullBridge()

    return RosBridge(
        bus,
        submit,
        namespace=namespace,
        ros_args=ros_args,
        robot_state=robot_state,
        state_hz=state_hz,
    )


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
