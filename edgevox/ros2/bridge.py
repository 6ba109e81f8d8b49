"""The bridge: the node with all of its parts."""

from collections.abc import Sequence
from typing import Protocol

from edgevox.core.commands import RunSkill
from edgevox.core.errors import InvalidValue
from edgevox.robots.capabilities import Body
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.interop import Interop
from edgevox.ros2.node import RosBridgeFailed, RosNode
from edgevox.ros2.parameters import Parameters, declare
from edgevox.ros2.queries import QueryServices
from edgevox.ros2.skill_action import open_skill_action
from edgevox.ros2.topics import Topics
from edgevox.ros2.wiring import Wiring


class Part(Protocol):
    """One concern of the bridge, served from its making to `close`."""

    def close(self) -> None: ...


class RosBridge:
    """EdgeVox as a ROS 2 node: what `contract` promises, served until `close`.

    Raises `RosBridgeFailed` where ROS 2 does not work or a parameter cannot be honoured.
    """

    def __init__(self, wiring: Wiring, ros_args: Sequence[str] = ()) -> None:
        self._node = RosNode(wiring.settings.ros2_namespace, ros_args)
        self._parts: list[Part] = []
        try:
            self._open(wiring)
        except InvalidValue as error:
            self.close()
            raise RosBridgeFailed(str(error)) from None

    def start(self) -> None:
        self._node.start()

    def close(self) -> None:
        """No more messages in or out, and nothing left behind."""
        for part in reversed(self._parts):
            part.close()
        self._node.close()

    @property
    def where(self) -> str:
        """The node's full name, for people."""
        return self._node.name

    def _open(self, wiring: Wiring) -> None:
        node, bus, controls = self._node.node, wiring.bus, wiring.controls
        values = declare(
            node,
            {
                "language": controls.language,
                "voice": controls.voice,
                "muted": controls.muted,
                "odom_frame": wiring.settings.odom_frame,
                "frame_prefix": wiring.settings.frame_prefix,
            },
        )
        controls.change({name: values[name] for name in ("language", "voice", "muted")})
        self._parts = [
            Parameters(node, self._node.executor, controls, bus),
            Topics(node, wiring),
            QueryServices(node, wiring.queries),
        ]
        if wiring.goals and (action := open_skill_action(node, bus, wiring.goals)):
            self._parts.append(action)
        if wiring.body and not isinstance(wiring.body, ExternalRobot):  # it has its own topics
            self._parts.append(_interop(self._node, wiring, wiring.body, values))


def _interop(ros: RosNode, wiring: Wiring, body: Body, values: dict[str, str | bool]) -> Interop:
    return Interop(
        ros.node,
        body,
        lambda name, arguments: wiring.submit(RunSkill(name, arguments)),
        odom_frame=str(values["odom_frame"]),
        frame_prefix=str(values["frame_prefix"]),
    )
