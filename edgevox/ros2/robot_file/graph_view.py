"""What the graph shows at one moment: who serves, publishes and subscribes, and as which type."""

import contextlib
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from rclpy.action import get_action_server_names_and_types_by_node
from rclpy.duration import Infinite
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

from edgevox.ros2.robot_file.wanted import Role

_OF_EVERY_NODE = "rcl_interfaces/"
_HIDDEN = "/_"


@dataclass(frozen=True, slots=True)
class OfferedEnd:
    """One end of an interface that is there; `profile` is a topic's quality of service."""

    type: str
    profile: QoSProfile | None = None


Offers = Mapping[Role, Mapping[str, list[OfferedEnd]]]
"""What is there, by role and by full name."""


def look_at(node: Node) -> Offers:
    """What the other nodes have. What only clients of a service or an action look for is not."""
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


def unheard(publisher: QoSProfile, subscriber: QoSProfile) -> str:
    """Why a subscriber would hear nothing of a publisher; empty if it would."""
    verdict, reason = qos_check_compatible(publisher, subscriber)
    if verdict != QoSCompatibility.ERROR:
        return ""
    said = str(reason).replace("ERROR: ", "").strip("; ")
    return said[:1].lower() + said[1:]


def as_on_the_graph(profile: QoSProfile) -> QoSProfile:
    """What is left to the middleware, as it says it of others: for ever."""
    profile.deadline = profile.lifespan = profile.liveliness_lease_duration = Infinite
    return profile


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
