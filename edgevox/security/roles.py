"""Who may do what: each role's rights, from the tables of the contract and nothing else."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from edgevox.ros2.contract import (
    ACTION,
    DIAGNOSTICS,
    EXTERNAL_NODE,
    HEARERS,
    NODE_NAME,
    PRESENCE,
    PUBLISHED,
    QUERIES,
    RECORDER_NODE,
    SHARED,
    SUBSCRIBED,
    TAKE_OVER,
)
from edgevox.ros2.contract_rows import StandardTopic
from edgevox.ros2.robot_file.format import RobotFile
from edgevox.ros2.robot_file.graph import Role as Interface
from edgevox.ros2.robot_file.graph import wanted_by
from edgevox.ros2.robot_file.load import load_robot_file
from edgevox.ros2.standard_topics import AUDIO, EXTERNAL, INTEROP, NAV2_ACTION, STANDARD
from edgevox.security.documents import (
    CLOCK,
    ROSOUT,
    Rights,
    calls,
    calls_action,
    calls_node,
    is_node,
    publishes,
    serves,
    serves_action,
    subscribes,
    union,
    watches_action,
)

ROS2CLI = "/_ros2cli_*"
"""The nodes of the `ros2` command, which are called after their process, and its daemon."""
EXTERNAL_ROBOT = "robot-external"


class EnclaveRole(StrEnum):
    """Whom an enclave is for."""

    ROBOT = "robot"
    RECORDER = "recorder"
    TOOLS = "tools"
    LISTENER = "listener"


@dataclass(frozen=True, slots=True)
class Graph:
    """Where a robot is on the graph: what the rights of whoever deals with it follow from.

    `robot_namespace` and `robot_file` are those of robot-external.
    """

    namespace: str
    robot: str
    robot_namespace: str = "/"
    robot_file: Path | None = None

    @property
    def node(self) -> str:
        """The agent's full name."""
        return self.at(NODE_NAME)

    def at(self, name: str) -> str:
        """The full name of what the contract calls so."""
        return absolute(self.namespace, name)

    def described(self) -> tuple[str, RobotFile]:
        """Of robot-external: the robot's namespace and file. Raises `InvalidValue`."""
        if self.robot_file is None:
            return self.robot_namespace, RobotFile()
        robot = load_robot_file(self.robot_file).robot
        said = robot.namespace if "namespace" in robot.model_fields_set else "/"
        return (self.robot_namespace if self.robot_namespace != "/" else said), robot


def absolute(namespace: str, name: str) -> str:
    """A name in a namespace; one that begins with a slash stays."""
    return name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"


def node_name(role: EnclaveRole) -> str:
    """How the node of a role is called, by which its enclave is called, too."""
    names = {EnclaveRole.ROBOT: NODE_NAME, EnclaveRole.RECORDER: RECORDER_NODE}
    return names.get(role, str(role))


def rights_of(role: EnclaveRole, graph: Graph, enclave: str) -> Rights:
    """All that an enclave of this role may. Raises `InvalidValue` for a robot file's mistakes."""
    match role:
        case EnclaveRole.ROBOT:
            return _agent(graph)
        case EnclaveRole.RECORDER:
            own = is_node(graph.at(RECORDER_NODE)) | publishes(DIAGNOSTICS.topic)
            return own | hears(graph) | _hears_sound(graph)
        case EnclaveRole.LISTENER:
            return _shell(enclave) | hears(graph)
        case EnclaveRole.TOOLS:
            return _shell(enclave) | hears(graph) | _hears_sound(graph) | _commands(graph)


def hears(graph: Graph) -> Rights:
    """To hear all that a robot says and is told, but for sound."""
    agent = union([_talks(graph), _moves(graph)])
    topics = {name for name in agent.publish | agent.subscribe if name.startswith("rt/")}
    return (
        Rights(subscribe=frozenset(topics))
        | subscribes(ROSOUT)
        | watches_action(graph.at(ACTION[0]))
    )


def _agent(graph: Graph) -> Rights:
    queries = serves(*map(graph.at, QUERIES))
    action = serves_action(graph.at(ACTION[0]))
    sound = _standard(graph.namespace, AUDIO)
    return union([is_node(graph.node), _talks(graph), queries, action, sound, _moves(graph)])


def _talks(graph: Graph) -> Rights:
    out = [row.topic for row in PUBLISHED] + [DIAGNOSTICS.topic, PRESENCE.topic, HEARERS.topic]
    into = [row.topic for row in SUBSCRIBED] + [row.topic for row in (*SHARED, HEARERS)]
    heard = [*map(graph.at, into), DIAGNOSTICS.topic]
    return publishes(*map(graph.at, out)) | subscribes(*heard)


def _moves(graph: Graph) -> Rights:
    """What comes of the body: one of ours, or a robot of its own that the agent drives."""
    if graph.robot != EXTERNAL_ROBOT:
        return _standard(graph.namespace, INTEROP)
    namespace, robot = graph.described()
    pictures = publishes(graph.at(STANDARD["picture"].topic))
    driven = is_node(absolute(namespace, EXTERNAL_NODE)) | _robot_file(namespace, robot) | pictures
    return driven | _drives(namespace) if robot.drives else driven


def _drives(namespace: str) -> Rights:
    frames = ("/tf", "/tf_static", absolute(namespace, "tf"), absolute(namespace, "tf_static"))
    nav2 = calls_action(absolute(namespace, NAV2_ACTION))
    return _standard(namespace, EXTERNAL) | subscribes(*frames, CLOCK) | nav2


def _robot_file(namespace: str, robot: RobotFile) -> Rights:
    have: dict[Interface, Callable[[str], Rights]] = {
        "publisher": subscribes,
        "subscriber": publishes,
        "service": calls,
        "action": calls_action,
    }
    wanted = wanted_by(robot)
    return union(have[one.role](absolute(namespace, one.name)) for one in wanted)


def _standard(namespace: str, rows: Iterable[StandardTopic]) -> Rights:
    return union(
        (publishes if row.direction == "out" else subscribes)(absolute(namespace, row.topic))
        for row in rows
    )


def _hears_sound(graph: Graph) -> Rights:
    return subscribes(*(graph.at(row.topic) for row in AUDIO))


def _commands(graph: Graph) -> Rights:
    """All that the agent takes from others; what it drives itself, it drives alone."""
    topics = [TAKE_OVER.topic, *(row.topic for row in SUBSCRIBED)]
    if graph.robot != EXTERNAL_ROBOT:
        topics += [row.topic for row in INTEROP if row.direction == "in"]
    topics += [row.topic for row in AUDIO if row.direction == "in"]
    services = calls(*map(graph.at, QUERIES)) | calls_node(graph.node)
    return publishes(*map(graph.at, topics)) | services | calls_action(graph.at(ACTION[0]))


def _shell(enclave: str) -> Rights:
    """The `ros2` command, and a node that is called as its enclave."""
    return is_node(ROS2CLI) | is_node(enclave)
