"""The bridge: the node with all of its parts."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from rclpy.node import Node

from edgevox.core.commands import RunSkill
from edgevox.core.errors import InvalidValue
from edgevox.core.status import Component
from edgevox.core.ways import Way
from edgevox.robots.capabilities import Body
from edgevox.robots.node_handle import OnRos2
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.bridge_context import BridgeContext
from edgevox.ros2.bridge_status import ExecutorComponent, ExecutorCounts
from edgevox.ros2.contract import PARAMETERS
from edgevox.ros2.diagnostics import DiagnosticsPublisher
from edgevox.ros2.interop import Interop
from edgevox.ros2.logs import Rosout
from edgevox.ros2.node import RosBridgeFailed, RosNode
from edgevox.ros2.parameters import Parameters, declare
from edgevox.ros2.presence import Presence
from edgevox.ros2.query_services import QueryServices
from edgevox.ros2.skill_action import open_skill_action
from edgevox.ros2.ticker import MakeTicker, Ticker
from edgevox.ros2.topics import Topics


class BridgePart(Protocol):
    """One concern of the bridge, served from its making to `close`."""

    def close(self) -> None: ...


@runtime_checkable
class Refuses(Protocol):
    """Takes messages, and not every one."""

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """How many were refused, by topic and reason."""


class RosBridge:
    """EdgeVox as a ROS 2 node: what `contract` promises, served until `close`.

    What comes at a rate is ticked by what `tickers` makes: one for all, one for the camera, and one
    for /diagnostics, which must say it when a body keeps the first one waiting.
    Raises `RosBridgeFailed` where ROS 2 does not work or a parameter cannot be honoured.
    """

    def __init__(
        self, context: BridgeContext, ros_args: Sequence[str] = (), tickers: MakeTicker = Ticker
    ) -> None:
        self._node = RosNode(context.settings.agent_namespace, ros_args)
        self._ticker, self._tickers = tickers("edgevox-ticker"), tickers
        self._watching = tickers("edgevox-diagnostics")
        self._body = context.body
        self._parts: list[BridgePart] = []
        try:
            self._open(context)
        except InvalidValue as error:
            self.close()
            raise RosBridgeFailed(str(error)) from None

    def start(self) -> None:
        self._node.start()
        self._ticker.start()
        self._watching.start()

    def close(self) -> None:
        """No more messages in or out, and nothing left behind."""
        for part in reversed(self._parts):
            part.close()
        self._watching.close()
        self._ticker.close()
        self._node.close()

    @property
    def where(self) -> str:
        """The node's full name, for people."""
        return self._node.name

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """How many messages were refused, by topic and reason."""
        parts: tuple[object, ...] = (*self._parts, self._body)
        refusing = [part for part in parts if isinstance(part, Refuses)]
        return {which: count for part in refusing for which, count in part.refusals.items()}

    @property
    def components(self) -> Sequence[Component]:
        """What says how it is."""
        return (ExecutorComponent(self._counts), self._presence)

    def _counts(self) -> ExecutorCounts:
        node = self._node
        failed_images = (one.failed_images for one in self._parts if isinstance(one, Interop))
        failed_ticks = self._ticker.failures + self._watching.failures
        return ExecutorCounts(
            node.stalled_s, node.failed, node.lag_s, failed_ticks, sum(failed_images)
        )

    def _open(self, context: BridgeContext) -> None:
        node, bus, controls = self._node.node, context.bus, context.controls
        values = declare(
            node,
            {
                "language": controls.language,
                "voice": controls.voice,
                "muted": controls.muted,
                "confirm": controls.confirm,
                **{
                    row.name: getattr(context.settings, row.name)
                    for row in PARAMETERS
                    if row.read_only
                },
            },
        )
        controls.change({name: values[name] for name in ("language", "voice", "muted", "confirm")})
        robot = context.body.name if context.body else ""
        self._presence = Presence(node, robot, context.interlock, self._ticker)
        backlog = Backlog(node, context.interlock)
        self._parts = [
            backlog,
            self._presence,
            Rosout(node, self._ticker),
            Parameters(node, self._node.executor, controls, bus),
            Topics(node, context, self._ticker, backlog),
            QueryServices(node, context.queries),
        ]
        self._parts += _audio(node, context)
        if context.components:
            self._parts.append(DiagnosticsPublisher(node, context.components, self._watching))
        if context.handle:
            context.handle.open(node)
            self._parts.append(context.handle)
        if context.goals and (action := open_skill_action(node, bus, context.goals, backlog)):
            self._parts.append(action)
        if context.body and not isinstance(context.body, OnRos2):  # it has its own topics
            self._parts.append(self._interop(context, context.body, values, backlog))

    def _interop(
        self,
        context: BridgeContext,
        body: Body,
        values: dict[str, str | bool],
        backlog: Backlog,
    ) -> Interop:
        def run_skill(name: str, arguments: Mapping[str, Any], mark: int) -> None:
            """At once, as a program's goal; where nobody runs those, as a command."""
            if context.goals:
                context.goals.start_goal(name, arguments, way=Way.GOAL_POSE, mark=mark)
            else:
                context.submit(RunSkill(name, arguments, Way.GOAL_POSE), mark)

        return Interop(
            self._node.node,
            body,
            run_skill,
            self._ticker,
            backlog,
            odom_frame=str(values["odom_frame"]),
            frame_prefix=str(values["frame_prefix"]),
            publish_clock=bool(values["publish_clock"]),
            interlock=context.interlock,
            guard=context.guard,
            tickers=self._tickers,
        )


def _audio(node: Node, context: BridgeContext) -> list[BridgePart]:
    """Microphone and loudspeaker on the wire. Their message is in edgevox_msgs."""
    parts: list[BridgePart] = []
    if context.audio_in:
        from edgevox.ros2.audio_in import AudioIn

        parts.append(AudioIn(node, context.audio_in))
    if context.audio_out:
        from edgevox.ros2.audio_out import AudioOut

        parts.append(AudioOut(node, context.audio_out))
    return parts
