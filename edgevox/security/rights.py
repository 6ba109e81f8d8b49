"""What a participant may have on the wire, as the names that DDS knows: of topics, of services."""

from collections.abc import Iterable
from dataclasses import dataclass

DISCOVERY = "ros_discovery_info"
"""On which every ROS 2 participant says which nodes it has."""
ROSOUT, PARAMETER_EVENTS, CLOCK = "/rosout", "/parameter_events", "/clock"
NODE_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
    "get_type_description",
    "get_logger_levels",
    "set_logger_levels",
)
"""What a node offers of itself, below its name."""
_ACTION_SERVICES = ("send_goal", "cancel_goal", "get_result")
_ACTION_TOPICS = ("feedback", "status")


@dataclass(frozen=True, slots=True)
class Rights:
    """Names of DDS topics that may be written and read; ``*`` stands for any characters."""

    publish: frozenset[str] = frozenset()
    subscribe: frozenset[str] = frozenset()

    def __or__(self, other: "Rights") -> "Rights":
        return Rights(self.publish | other.publish, self.subscribe | other.subscribe)


def union(rights: Iterable[Rights]) -> Rights:
    """All of them together."""
    every = list(rights)
    return Rights(
        frozenset(name for one in every for name in one.publish),
        frozenset(name for one in every for name in one.subscribe),
    )


def publishes(*topics: str) -> Rights:
    """The right to publish topics, by their full ROS 2 names."""
    return Rights(publish=frozenset(f"rt{topic}" for topic in topics))


def subscribes(*topics: str) -> Rights:
    """The right to hear topics."""
    return Rights(subscribe=frozenset(f"rt{topic}" for topic in topics))


def serves(*services: str) -> Rights:
    """The right to answer services."""
    return Rights(
        publish=frozenset(f"rr{service}Reply" for service in services),
        subscribe=frozenset(f"rq{service}Request" for service in services),
    )


def calls(*services: str) -> Rights:
    """The right to ask services."""
    asked = serves(*services)
    return Rights(publish=asked.subscribe, subscribe=asked.publish)


def serves_action(action: str) -> Rights:
    """The right to do an action for others."""
    return serves(*_services_of(action)) | publishes(*_topics_of(action))


def calls_action(action: str) -> Rights:
    """The right to have an action done, and to cancel it."""
    return calls(*_services_of(action)) | watches_action(action)


def watches_action(action: str) -> Rights:
    """The right to hear how an action's goals are."""
    return subscribes(*_topics_of(action))


def is_node(name: str) -> Rights:
    """What a node of this full name needs to be one, and its own services."""
    own = (f"{name}/{service}" for service in NODE_SERVICES)
    discovery = Rights(frozenset({DISCOVERY}), frozenset({DISCOVERY}))
    told = publishes(ROSOUT, PARAMETER_EVENTS) | subscribes(PARAMETER_EVENTS, CLOCK)
    return serves(*own) | discovery | told


def calls_node(name: str) -> Rights:
    """The right to ask for and set a node's parameters and levels."""
    return calls(*(f"{name}/{service}" for service in NODE_SERVICES))


def _services_of(action: str) -> list[str]:
    return [f"{action}/_action/{name}" for name in _ACTION_SERVICES]


def _topics_of(action: str) -> list[str]:
    return [f"{action}/_action/{name}" for name in _ACTION_TOPICS]
