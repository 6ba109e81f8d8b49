"""A look for a robot file's interfaces on the live graph, for the doctor's process.

`wanted_by` lists the interfaces that a file needs. `look_at` lists the graph's servers, publishers
and subscribers with their types. The result for each interface has plain values: its types there,
its quality of service, and similar interfaces that may have been meant.
"""

import contextlib
import difflib
import json
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from rclpy.action import get_action_server_names_and_types_by_node
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import QoSProfile

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings, check_settings
from edgevox.ros2.clients import TookTooLong, wait_until
from edgevox.ros2.messages import as_on_the_graph, interface_profile, profile, unheard
from edgevox.ros2.node import RosNode
from edgevox.ros2.robot_file.format import RobotFile, SkillEntry
from edgevox.ros2.robot_file.load import NO_FILE, DescribedRobot
from edgevox.ros2.robot_file.messages import InterfaceMissing, Kind, full_name
from edgevox.ros2.robot_file.skills import LoadedFile, load_described
from edgevox.ros2.robot_file.steps import Step, Topic
from edgevox.ros2.standard_topics import DRIVEN

Role = Literal["service", "action", "publisher", "subscriber"]
"""The robot's side of an interface: the opposite of EdgeVox's."""

_ROLES: dict[str, tuple[Role, Kind]] = {
    "publish": ("subscriber", "msg"),
    "call": ("service", "srv"),
    "action": ("action", "action"),
    "read": ("publisher", "msg"),
    "wait": ("publisher", "msg"),
}
TOPICS = "topics"
"""Owner of the contract's topics that the robot names differently."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """An interface that the file needs."""

    whose: str
    """The skill that needs it."""
    role: Role
    name: str
    """As the file writes it."""
    type: str
    latched: bool = False
    contract: str = ""
    """The contract's name for a topic that belongs to no skill."""

    @property
    def types(self) -> tuple[str, ...]:
        """The types that EdgeVox can use there."""
        return DRIVEN[self.contract].types if self.contract else (self.type,)


def wanted_by(robot: RobotFile) -> Iterator[Wanted]:
    """Every interface that the file names, of skills whose types make sense, each once a skill."""
    for topic, name in robot.topics.items():
        yield _wanted_by_contract(topic, name)
    for state, told in robot.state.items():
        with contextlib.suppress(InterfaceMissing):  # it is off, which is told by itself
            yield Wanted(state, "publisher", told.topic, full_name(told.type, "msg"), told.latched)
    for skill, entry in robot.skills.items():
        yield from dict.fromkeys(_wanted_by_steps(skill, entry))


def _wanted_by_contract(topic: str, name: str) -> Wanted:
    row = DRIVEN[topic]
    role: Role = "publisher" if row.direction == "in" else "subscriber"
    return Wanted(TOPICS, role, name, row.type, contract=topic)


def _wanted_by_steps(skill: str, entry: SkillEntry) -> Iterator[Wanted]:
    watches = [Step(wait=one) for one in entry.stops_on]
    for step in (*entry.every_step, *watches, *([entry.stop] if entry.stop else ())):
        way = step.ways[0]
        role, kind = _ROLES[way]
        used = getattr(step, way)
        try:
            type_name = full_name(used.type, kind)
        except InterfaceMissing:
            continue  # the skill is off, which is told by itself
        latched = isinstance(used, Topic) and used.latched
        yield Wanted(skill, role, used.name, type_name, latched)


_OF_EVERY_NODE = "rcl_interfaces/"
_HIDDEN = "/_"


@dataclass(frozen=True, slots=True)
class OfferedEnd:
    """An interface that is there."""

    type: str
    profile: QoSProfile | None = None
    """A topic's quality of service."""


Offers = Mapping[Role, Mapping[str, list[OfferedEnd]]]
"""The interfaces that are there, by role and full name."""


def look_at(node: Node) -> Offers:
    """List the other nodes' interfaces, without the clients of services and actions."""
    found: dict[Role, dict[str, list[OfferedEnd]]] = {
        "service": defaultdict(list),
        "action": defaultdict(list),
        "publisher": defaultdict(list),
        "subscriber": defaultdict(list),
    }
    for name, namespace in node.get_node_names_and_namespaces():
        if (name, namespace) == (node.get_name(), node.get_namespace()):
            continue
        # A node may go between two looks.
        with contextlib.suppress(NodeNameNonExistentError):
            _add(found["service"], node.get_service_names_and_types_by_node(name, namespace))
            actions = get_action_server_names_and_types_by_node(node, name, namespace)
            _add(found["action"], actions)
    for role, ends in _topic_ends(node):
        for topic, _ in node.get_topic_names_and_types():
            for end in ends(topic):
                if not _hidden(topic) and end.node_name != node.get_name():
                    found[role][topic].append(OfferedEnd(end.topic_type, end.qos_profile))
    return found


def _topic_ends(node: Node) -> Iterator[tuple[Role, Callable[[str], list[Any]]]]:
    yield "publisher", node.get_publishers_info_by_topic
    yield "subscriber", node.get_subscriptions_info_by_topic


def _add(known: dict[str, list[OfferedEnd]], served: list[tuple[str, list[str]]]) -> None:
    for name, types in served:
        ends = [OfferedEnd(one) for one in types if not one.startswith(_OF_EVERY_NODE)]
        if ends and not _hidden(name):
            known[name].extend(ends)


def _hidden(name: str) -> bool:
    return _HIDDEN in name


LOOK_S = 5.0
"""Seconds that the discovery may take."""
NODE_NAME = "edgevox_doctor"
MOST_NEAR = 3
_ALIKE = 0.6


_ESSENTIAL = {topic: topic for topic in ("odom", "cmd_vel")}
WITHOUT_FILE = replace(NO_FILE, robot=RobotFile(topics=_ESSENTIAL))
"""A robot that only a setting names: what every robot that drives has."""


def look_for_robot(settings_json: str) -> dict[str, Any]:
    """Look for the robot that these settings name, by its file or by its namespace alone.

    The result's keys: `wrong`, all that is wrong with the file; `off`, skills whose types are not
    sourced; `others`, the number of nodes; `found`, one entry for each interface; `elsewhere`, the
    namespace that most of them are in, and how many.
    """
    settings = check_settings(json.loads(settings_json))
    facts: dict[str, Any] = {"wrong": [], "off": [], "others": 0, "found": []}
    try:
        loaded = (
            load_described(settings.robot_file) if settings.robot_file else LoadedFile(WITHOUT_FILE)
        )
    except InvalidValue as error:
        return facts | {"wrong": [str(one) for one in error.problems]}
    facts["off"] = [list(one) for one in loaded.off.items()]
    return facts | _on_the_graph(loaded.described, settings)


def _on_the_graph(described: DescribedRobot, settings: Settings) -> dict[str, Any]:
    namespace = described.namespace(settings)
    ros = RosNode("/", name=NODE_NAME)
    ros.start()
    try:
        wanted = [
            (one, expand_topic_name(one.name, NODE_NAME, namespace))
            for one in wanted_by(described.robot)
        ]
        offers = _until_all_are_there(ros, wanted)
        wanted += _misfits(described.robot, namespace, offers)
        others = len(ros.node.get_node_names()) - 1
    finally:
        ros.close()
    found = [_told(one, name, offers) for one, name in wanted]
    return {"others": others, "found": found, "elsewhere": _elsewhere(wanted, offers)}


def _misfits(robot: RobotFile, namespace: str, offers: Offers) -> Iterator[tuple[Wanted, str]]:
    """Yield topics of the contract that keep their names and have another type there."""
    for topic in DRIVEN if robot.drives else ():
        wanted, name = (
            _wanted_by_contract(topic, topic),
            expand_topic_name(topic, NODE_NAME, namespace),
        )
        there = {one.type for one in offers[wanted.role].get(name, ())}
        if topic not in robot.topics and there and there.isdisjoint(wanted.types):
            yield wanted, name


def _until_all_are_there(ros: RosNode, wanted: Sequence[tuple[Wanted, str]]) -> Offers:
    seen: list[Offers] = []

    def complete() -> bool:
        seen.append(look_at(ros.node))
        return all(seen[-1][one.role].get(name) for one, name in wanted)

    # What does not come is what is asked for.
    with contextlib.suppress(TookTooLong):
        wait_until(complete, CancelToken(), LOOK_S, SystemClock())
    return seen[-1]


def _told(wanted: Wanted, name: str, offers: Offers) -> dict[str, Any]:
    ends = offers[wanted.role].get(name, [])
    types = sorted({one.type for one in ends})
    right = [one.profile for one in ends if one.type in wanted.types and one.profile]
    unfit = _unfit(wanted, right, latched=wanted.latched)
    return {
        "whose": wanted.whose,
        "role": wanted.role,
        "name": name,
        "contract": wanted.contract,
        "type": " or ".join(wanted.types),
        "fits": not types or not set(types).isdisjoint(wanted.types),
        "types": types,
        "unfit": unfit,
        "latched": not wanted.latched
        if unfit and not _unfit(wanted, right, latched=not wanted.latched)
        else None,
        "instead": [role for role in offers if role != wanted.role and offers[role].get(name)],
        "near": [] if types else [list(one) for one in _near(wanted, name, offers)],
    }


def _unfit(wanted: Wanted, theirs: Sequence[QoSProfile], *, latched: bool) -> str:
    """Return the reason why none of the ends matches EdgeVox's; empty if one does."""
    heard = wanted.role == "publisher"
    contract = profile(DRIVEN[wanted.contract].qos) if wanted.contract else None
    ours = as_on_the_graph(contract or interface_profile(latched=latched, heard=heard))
    reasons = [unheard(one, ours) if heard else unheard(ours, one) for one in theirs]
    return reasons[0] if reasons and all(reasons) else ""


def _elsewhere(wanted: Sequence[tuple[Wanted, str]], offers: Offers) -> list[Any]:
    """Return the namespace that has most of the relative names, and how many; empty without one."""
    found = Counter(
        name.removesuffix(f"/{one.name}")
        for one, _ in wanted
        for name in offers[one.role]
        if name.endswith(f"/{one.name}")
    )
    return [[namespace or "/", count] for namespace, count in found.most_common(1)]


def _near(wanted: Wanted, name: str, offers: Offers) -> Iterator[tuple[str, str]]:
    """Yield interfaces of this role with a similar name or the same type, with their types."""
    known = {
        other: sorted({end.type for end in ends}) for other, ends in offers[wanted.role].items()
    }
    alike = sorted(known, key=lambda other: -_likeness(name, other))
    alike = [other for other in alike if _likeness(name, other) >= _ALIKE]
    same_type = [other for other in sorted(known) if set(wanted.types) & set(known[other])]
    for other in list(dict.fromkeys([*alike, *same_type]))[:MOST_NEAR]:
        yield other, ", ".join(known[other])


def _likeness(name: str, other: str) -> float:
    """Return the likeness, 0 to 1, of whole names or of last parts, if namespaces differ."""
    pairs = ((name, other), (name.rpartition("/")[2], other.rpartition("/")[2]))
    return max(difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)
