"""EdgeVox's side of the bridge, and how the bridge is opened.

Where there is no ROS 2, `NullBridge` stands in for it. Also here: what the environment must say for
rclpy to work, and the bridge's own status, of the components `executor` and `presence`. Does not
import rclpy.
"""

import importlib.util
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol

from edgevox.agent.policy import Guard
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.commands import Submit
from edgevox.core.controls import Controls
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.hearers import Hearers
from edgevox.core.motion.interlock import Interlock
from edgevox.core.settings import Settings
from edgevox.core.status import (
    Component,
    ComponentName,
    Components,
    Finding,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    moves,
    stall,
)
from edgevox.robots.capabilities import Body
from edgevox.ros2.contract import Queries
from edgevox.voice.sinks.paced import Relay
from edgevox.voice.sources.pushed import Pushed

if TYPE_CHECKING:
    from edgevox.ros2.agent_node_handle import AgentNodeHandle
    from edgevox.ros2.skill_action import StartsGoals


@dataclass(frozen=True)
class BridgeContext:
    """EdgeVox's side of a bridge."""

    settings: Settings
    bus: Bus
    """Source of the events that go out."""
    submit: Submit
    """Takes each command; raises `InvalidValue`."""
    controls: Controls
    queries: Queries
    body: Body | None = None
    """None for an agent without a robot: then there are no `robot_state`, `agent_event`, robot
    topics or action."""
    goals: "StartsGoals | None" = None
    """Runs the skills of `execute_skill`; None without a body."""
    audio_in: Pushed | None = None
    """Filled from the topic `audio_in`."""
    audio_out: Relay | None = None
    """Sent to the topic `audio_out`."""
    components: Components | None = None
    """The components that report their status."""
    interlock: Interlock = field(default_factory=Interlock)
    """Engaged while another agent of the namespace moves the robot."""
    guard: Guard = field(default_factory=Guard)
    """The policy for velocities and for `command`; goals are judged by `goals`."""
    handle: "AgentNodeHandle | None" = None
    """Lends the node to skills."""
    hearers: Hearers | None = None
    """The robots of its group that hear the same person; None without a group."""


@dataclass(frozen=True, slots=True)
class ExecutorCounts:
    """The condition of the node's threads."""

    stalled_s: float = 0.0
    """Seconds for which one callback has held up all others."""
    failed_callbacks: int = 0
    """Callbacks that raised."""
    lag_s: float = 0.0
    """The longest wait of a callback in the last minute, in seconds."""
    failed_ticks: int = 0
    """Periodic jobs that raised."""
    failed_images: int = 0
    """Pictures that could not be taken."""


class ExecutorComponent:
    """Status of the executor: a callback that holds up the others is a warning, later an error.

    A failed callback is also a warning. `missing` is the reason why the node is not on ROS 2; empty
    if it is.
    """

    name = ComponentName.EXECUTOR

    def __init__(
        self, look: Callable[[], ExecutorCounts], missing: str = "", clock: Clock | None = None
    ) -> None:
        self._look, self._missing = look, missing
        self._failing = RecentIncrease(clock)
        self.checks = (
            HealthCheck("ros2", moves(lambda: look().stalled_s)),
            HealthCheck("rclpy", lambda: missing, vital=False),
        )

    def status(self) -> Status:
        """Return the current status."""
        now = self._look()
        found = stall(now.stalled_s, "a callback holds up all others: the node has")
        if self._missing:
            found.append(Finding(Level.ERROR, f"not on ROS 2: {self._missing}"))
        if self._failing.grew(now.failed_callbacks):
            text = f"a callback failed, {now.failed_callbacks} by now; the log says why"
            found.append(Finding(Level.WARN, text))
        return Status.judged(self.name, found, well="turns", **asdict(now))


@dataclass(frozen=True, slots=True)
class Sharing:
    """The agents that share a namespace."""

    namespace: str
    id: str
    """This agent's id there."""
    others: tuple[str, ...] = ()
    """The other agents, in words."""
    yields: bool = False
    """True if this agent refuses to move because another one is in charge."""
    group: tuple[str, ...] | None = None
    """The names of the other robots of its group; None without a group."""

    def status(self) -> Status:
        """Another agent is a warning; to refuse to move for its sake is an error."""
        found = []
        if self.others:
            found.append(Finding(Level.WARN, f"also on {self.namespace}: {', '.join(self.others)}"))
        if self.yields:
            text = "refuses to move while another agent is in charge, unless told to take over"
            found.append(Finding(Level.ERROR, text))
        return Status.judged(
            "presence",
            found,
            well=f"alone on {self.namespace}",
            id=self.id,
            others=len(self.others),
            in_charge=not self.yields,
            **({} if self.group is None else {"group": ", ".join(self.group)}),
        )


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


DOMAIN, MIDDLEWARE = "ROS_DOMAIN_ID", "RMW_IMPLEMENTATION"
LAST_DOMAIN = 232
"""The last for which DDS has ports."""


def installed_middlewares() -> list[str]:
    """The middlewares of ROS 2 that this environment can load, by its ament index."""
    prefixes = [sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    folders = [Path(p, "share/ament_index/resource_index/rmw_typesupport") for p in prefixes if p]
    names = {file.name for folder in folders if folder.is_dir() for file in folder.iterdir()}
    return sorted(names - {"rmw_implementation"})  # which loads one of the others


def domain_of(environment: Mapping[str, str]) -> int:
    """The domain of ROS 2's graph that is asked for. Raises `InvalidValue`."""
    said = environment.get(DOMAIN) or "0"
    if not (said.isascii() and said.isdecimal()) or int(said) > LAST_DOMAIN:
        raise InvalidValue(DOMAIN, said, f"a whole number from 0 to {LAST_DOMAIN}")
    return int(said)


def check_environment(environment: Mapping[str, str]) -> None:
    """Raise `InvalidValue` for what rclpy would end the process for as soon as it is imported."""
    if importlib.util.find_spec("rclpy") is None:
        return
    domain_of(environment)
    asked, here = environment.get(MIDDLEWARE, ""), installed_middlewares()
    if asked and here and asked not in here:
        raise InvalidValue(MIDDLEWARE, asked, f"one that is installed: {', '.join(here)}")


def open_bridge(context: BridgeContext, ros_args: Sequence[str] = ()) -> Bridge:
    """A bridge on real ROS 2, or a `NullBridge` where rclpy cannot be imported.

    Raises `EdgeVoxError` where rclpy is here but does not work: no robot is silent in secret.
    """
    check_environment(os.environ)
    try:
        import rclpy  # noqa: F401 - first, so that it is missing by its own name

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
        from edgevox.ros2.agent_node_handle import AgentNodeHandle
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
