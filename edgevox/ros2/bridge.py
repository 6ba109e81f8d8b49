"""The bridge: the node with all of its parts.

Its topics are those of `contract`, and `picture`: events go out, what comes in becomes commands.

Queries are services: a Trigger for each, whose message is the JSON that `info` carries.

The components' status goes out on `/diagnostics`, as rqt_robot_monitor and the aggregator expect
it. A status is called ``/robot1/edgevox: audio``: the node's full name and the component, as
diagnostic_updater does it with `use_fqn`. Its default, the short name, is the same for every robot
of a domain, so a listener would take two robots for one.

The node's parameters are the settings that topics can change, seen and changed as parameters.
"""

from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Protocol, runtime_checkable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float32, String
from std_srvs.srv import Trigger

from edgevox.agent.policy import CheckedCall, Denied
from edgevox.core.agent_events import AgentEvent
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import CancelProgram, Reset, RunSkill, Way
from edgevox.core.controls import Controls, Value
from edgevox.core.errors import EdgeVoxError, InvalidValue, Refusal
from edgevox.core.events import ControlChanged, PictureTaken, RobotState
from edgevox.core.files.text import printable
from edgevox.core.log import get_logger
from edgevox.core.status import (
    LATELY_S,
    Component,
    ComponentName,
    Components,
    HealthCheck,
    Level,
    Off,
    Status,
)
from edgevox.robots.capabilities import Body
from edgevox.robots.node_handle import OnRos2
from edgevox.robots.pictures import has_camera
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.contract import (
    DIAGNOSTICS,
    PARAMETERS,
    PUBLISHED,
    QUERIES,
    RECORDER_NODE,
    SUBSCRIBED,
    Queries,
    answer_json,
)
from edgevox.ros2.contract_rows import STRING, Published, Subscribed
from edgevox.ros2.interop import Interop
from edgevox.ros2.interop.frames import CAMERA_OPTICAL
from edgevox.ros2.logs import Rosout
from edgevox.ros2.messages import header, profile
from edgevox.ros2.node import RosBridgeFailed, RosNode
from edgevox.ros2.open import BridgeContext, ExecutorComponent, ExecutorCounts
from edgevox.ros2.presence import Presence
from edgevox.ros2.skill_action import open_skill_action
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.ticker import MakeTicker, Ticker

log = get_logger(__name__)

_TYPES: dict[str, Any] = {STRING: String, "std_msgs/msg/Float32": Float32}
_PNG = "rgb8; png compressed rgb8"
"""The format, as image_transport's plug-in of compressed images writes it."""
MOST_SAID = 300
"""Characters of another node's words that are passed on."""


class Topics:
    """Serves the rows of `PUBLISHED` and `SUBSCRIBED` on a node.

    The ticker reads the body's state, if there is a body, at the rate of the settings. `refusals`
    counts invalid and forbidden messages by topic and reason.
    """

    def __init__(
        self, node: Node, context: BridgeContext, ticker: Ticker, backlog: Backlog
    ) -> None:
        self._node = node
        self._bus = context.bus
        self._submit = context.submit
        self._guard = context.guard
        self.refusals: Counter[tuple[str, ...]] = Counter(
            {(row.topic, Refusal.INVALID): 0 for row in SUBSCRIBED}
            | {(row.topic, Refusal.FORBIDDEN): 0 for row in SUBSCRIBED if row.verbs}
        )
        self._forget: list[Callable[[], None]] = []
        body = context.body
        for published in PUBLISHED:
            if body or published.event not in (RobotState, AgentEvent):
                self._publish(published)
        for subscribed in SUBSCRIBED:
            backlog.subscribe(
                String,
                subscribed.topic,
                partial(self._receive, subscribed),
                profile(subscribed.qos),
            )
        if body:
            self._forget.append(
                ticker.every(
                    1.0 / context.settings.ros2_state_hz,
                    lambda: self._bus.publish(RobotState(body.state())),
                )
            )

    def close(self) -> None:
        """Publish nothing more."""
        for forget in self._forget:
            forget()

    def _publish(self, row: Published) -> None:
        kind = _TYPES[row.type]
        publisher = self._node.create_publisher(kind, row.topic, profile(row.qos))
        self._forget.append(
            self._bus.subscribe(
                row.event, lambda event: publisher.publish(kind(data=row.encode(event)))
            )
        )

    def _receive(self, row: Subscribed, message: String, mark: int) -> None:
        try:
            command = row.decode(message.data)
            if row.verbs and not isinstance(command, Reset | CancelProgram):  # to end is free
                self._guard.permit(Way.COMMAND, [CheckedCall(message.data.strip(), moves=False)])
            self._submit(command, mark)
        except InvalidValue as error:
            self._refuse(row.topic, error.reason, error)
        except Denied as denied:
            self._refuse(row.topic, Refusal.FORBIDDEN, denied)

    def _refuse(self, topic: str, why: Refusal, error: EdgeVoxError) -> None:
        self.refusals[topic, why] += 1
        log.warning("message_refused", topic=topic, reason=str(error))


class PicturePublisher:
    """Publishes each picture that the robot was asked to take, latched on `picture`."""

    def __init__(self, node: Node, bus: Bus, frame: str) -> None:
        """`frame` is the camera's optical frame."""
        row = STANDARD["picture"]
        publisher = node.create_publisher(CompressedImage, row.topic, profile(row.qos))

        def publish(event: PictureTaken) -> None:
            data = array("B")  # the one type that rclpy takes without looking at every byte
            data.frombytes(event.png)
            head = header(frame, node.get_clock().now().to_msg())
            publisher.publish(CompressedImage(header=head, format=_PNG, data=data))

        self.close = bus.subscribe(PictureTaken, publish)


def _serve_queries(node: Node, queries: Queries) -> None:
    """Serve the contract's queries until the node ends."""
    for name in QUERIES:
        node.create_service(Trigger, name, partial(_answer, name, queries[name]))


def _answer(
    name: str,
    ask: Callable[[], Mapping[str, Any]],
    _request: Trigger.Request,
    response: Trigger.Response,
) -> Trigger.Response:
    response.success = True
    response.message = answer_json(name, ask())
    return response


class DiagnosticsPublisher:
    """Publishes the report of all components, on the ticker: also when the executor hangs."""

    def __init__(self, node: Node, components: Components, ticker: Ticker) -> None:
        self._node = node
        self._components = components
        self._name = str(node.get_fully_qualified_name())
        row = DIAGNOSTICS
        self._publisher = node.create_publisher(DiagnosticArray, row.topic, profile(row.qos))
        self.close = ticker.every(1.0 / row.rate_hz, self.publish)

    def publish(self) -> None:
        """Publish the report now."""
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


class HeardRecorder:
    """What a recorder of this namespace, a program of its own, says of itself on `/diagnostics`.

    All nodes of a robot talk there, so only a message that names the recorder is looked into.
    """

    name = ComponentName.RECORDER
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, node: Node, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._said_by = f"{node.get_namespace().rstrip('/')}/{RECORDER_NODE}: {self.name}"
        self._heard_s = 0.0
        self._last: DiagnosticStatus | None = None
        try:
            node.create_subscription(
                DiagnosticArray, DIAGNOSTICS.topic, self.hear, profile(DIAGNOSTICS.qos), raw=True
            )
        except RuntimeError as error:  # an enclave of an older EdgeVox has no right to
            log.warning("recorder_unheard", reason=str(error))

    def hear(self, data: bytes) -> None:
        """Take a message as it came."""
        if self._said_by.encode() + b"\0" in data:
            for one in deserialize_message(data, DiagnosticArray).status:
                if one.name == self._said_by:
                    self._heard_s, self._last = self._clock.now(), one

    def status(self) -> Status:
        """Its last words, or that it has fallen silent without saying that it ended."""
        last = self._last
        if last is None:
            return Off(self.name, "none was heard").status()
        silent_s = self._clock.now() - self._heard_s
        ended = KeyValue(key="ended", value="true") in last.values
        if silent_s > LATELY_S and not ended:
            text = f"silent for {silent_s:.0f} s: it was killed, or hangs"
            return Status(self.name, Level.WARN, text, {"recording": False})
        level = Level(min(ord(last.level), Level.ERROR))
        said = printable(last.message[:MOST_SAID])
        return Status(self.name, level, said, {"recording": level < Level.ERROR and not ended})


def declare(node: Node, values: Mapping[str, Value]) -> dict[str, Value]:
    """Declare the contract's parameters, with `values` as defaults; return their values.

    Launch files, parameter files and ``-p`` overrule the defaults. Raises `InvalidValue` for a
    value of another type.
    """
    for row in PARAMETERS:
        descriptor = ParameterDescriptor(
            description=row.about,
            additional_constraints=row.constraints,
            read_only=row.read_only,
        )
        try:
            node.declare_parameter(row.name, values[row.name], descriptor)
        except InvalidParameterTypeException as error:
            raise InvalidValue(row.name, str(error), row.constraints) from None
    return {row.name: node.get_parameter(row.name).value for row in PARAMETERS}


_CONTROLS = ("language", "voice", "muted", "confirm")


class Parameters:
    """Keeps ROS 2 parameters and EdgeVox's controls equal, whichever side changes.

    The set call refuses a value that cannot be used, with the reason.
    """

    def __init__(self, node: Node, executor: Executor, controls: Controls, bus: Bus) -> None:
        self._node = node
        self._executor = executor
        self._controls = controls
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)
        self.close = bus.subscribe(ControlChanged, self._follow)

    def _check(self, wanted: Sequence[RosParameter]) -> SetParametersResult:
        try:
            self._controls.check(_controls_of(wanted))
        except InvalidValue as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, changed: Sequence[RosParameter]) -> None:
        """Make the change, and show what counts: it may be refused since the check, or reworded."""
        wanted = _controls_of(changed)
        try:
            self._controls.change(wanted)
        except InvalidValue as error:
            log.warning("parameter_not_applied", reason=str(error))
        self.show(wanted)

    def _follow(self, event: ControlChanged) -> None:
        """Show a change that came another way."""
        self.show((event.name,))

    def show(self, names: Iterable[str]) -> None:
        """Show what counts, soon: on the node's own thread, as rclpy wants it."""
        for name in names:
            self._executor.create_task(self._show, name)

    def _show(self, name: str) -> None:
        """Show the value that counts now: it may have changed again since the event."""
        value = getattr(self._controls, name)
        if self._node.get_parameter(name).value != value:
            self._node.set_parameters([RosParameter(name, value=value)])


def _controls_of(parameters: Sequence[RosParameter]) -> dict[str, Value]:
    return {one.name: one.value for one in parameters if one.name in _CONTROLS}


class BridgePart(Protocol):
    """A part of the bridge, active from its construction to `close`."""

    def close(self) -> None: ...


@runtime_checkable
class Refuses(Protocol):
    """Takes messages, and not every one."""

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of refused messages, by topic and reason."""


class RosBridge:
    """EdgeVox as a ROS 2 node: serves everything in `contract`, until `close`.

    Args:
        context: The objects of EdgeVox that it connects.
        ros_args: Arguments for ROS 2; by default the process's own.
        tickers: Makes a ticker by name: one for periodic messages, one for the camera, and one for
            /diagnostics, which must report a body that blocks the first.

    Raises `RosBridgeFailed` if ROS 2 does not work or a parameter cannot be used.
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
        """The number of refused messages, by topic and reason."""
        parts: tuple[object, ...] = (*self._parts, self._body)
        refusing = [part for part in parts if isinstance(part, Refuses)]
        return {which: count for part in refusing for which, count in part.refusals.items()}

    @property
    def components(self) -> Sequence[Component]:
        """The components that report their status."""
        return (ExecutorComponent(self._counts), self._presence, self._recorder)

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
                **{name: getattr(controls, name) for name in _CONTROLS},
                **{
                    row.name: getattr(context.settings, row.name)
                    for row in PARAMETERS
                    if row.read_only
                },
            },
        )
        controls.change({name: values[name] for name in _CONTROLS})
        robot = context.body.name if context.body else ""
        self._presence = Presence(node, robot, context.interlock, self._ticker, context.hearers)
        self._recorder = HeardRecorder(node)
        backlog = Backlog(node, context.interlock)
        parameters = Parameters(node, self._node.executor, controls, bus)
        parameters.show(_CONTROLS)
        self._parts = [
            backlog,
            self._presence,
            Rosout(node, self._ticker),
            parameters,
            Topics(node, context, self._ticker, backlog),
        ]
        _serve_queries(node, context.queries)
        self._parts += _audio(node, context)
        if context.components:
            self._parts.append(DiagnosticsPublisher(node, context.components, self._watching))
        if context.handle:
            context.handle.open(node)
            self._parts.append(context.handle)
        if context.goals and (action := open_skill_action(node, bus, context.goals, backlog)):
            self._parts.append(action)
        if context.body and has_camera(context.body):
            own = not isinstance(context.body, OnRos2)  # else its camera's frame is not known
            frame = f"{values['frame_prefix']}{CAMERA_OPTICAL}" if own else ""
            self._parts.append(PicturePublisher(node, bus, frame))
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
            """Run the skill at once, as a program's goal; without goals, as a command."""
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
        from edgevox.ros2.audio import AudioIn

        parts.append(AudioIn(node, context.audio_in))
    if context.audio_out:
        from edgevox.ros2.audio import AudioOut

        parts.append(AudioOut(node, context.audio_out))
    return parts
