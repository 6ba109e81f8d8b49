"""Governance and permissions, the two documents of DDS security, and the rights that they grant.

The documents are XML (OMG DDS-SECURITY 1.1). Rights are names as DDS knows them: of topics, of
services.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from xml.etree import ElementTree as ET

from edgevox.ros2.open import LAST_DOMAIN

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


_SCHEMAS = "http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_{}.xsd"
_SCHEMA = "{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation"
_PARTICIPANTS = {
    "allow_unauthenticated_participants": "false",
    "enable_join_access_control": "true",
    "discovery_protection_kind": "ENCRYPT",
    "liveliness_protection_kind": "ENCRYPT",
    "rtps_protection_kind": "ENCRYPT",
}
_TOPICS = {
    "topic_expression": "*",
    "enable_discovery_protection": "true",
    "enable_liveliness_protection": "true",
    "enable_read_access_control": "true",
    "enable_write_access_control": "true",
    "metadata_protection_kind": "ENCRYPT",
    "data_protection_kind": "ENCRYPT",
}


def governance() -> str:
    """For every domain: strangers are not let in, and everything that can be is encrypted."""
    root = _document("governance")
    rule = ET.SubElement(ET.SubElement(root, "domain_access_rules"), "domain_rule")
    every = ET.SubElement(ET.SubElement(rule, "domains"), "id_range")
    _fill(every, {"min": "0", "max": str(LAST_DOMAIN)})
    _fill(rule, _PARTICIPANTS)
    _fill(ET.SubElement(ET.SubElement(rule, "topic_access_rules"), "topic_rule"), _TOPICS)
    return _written(root)


def permissions(enclave: str, domain: int, begins: datetime, ends: datetime, rights: Rights) -> str:
    """What the enclave whose certificate has this name may do on one domain, in this time (UTC)."""
    root = _document("permissions")
    grant = ET.SubElement(ET.SubElement(root, "permissions"), "grant", name=enclave)
    ET.SubElement(grant, "subject_name").text = f"CN={enclave}"
    times = {"not_before": begins, "not_after": ends}
    _fill(
        ET.SubElement(grant, "validity"),
        {name: f"{time:%Y-%m-%dT%H:%M:%S}" for name, time in times.items()},
    )
    allowed = ET.SubElement(grant, "allow_rule")
    _fill(ET.SubElement(allowed, "domains"), {"id": str(domain)})
    _topics(ET.SubElement(allowed, "publish"), rights.publish)
    _topics(ET.SubElement(allowed, "subscribe"), rights.subscribe)
    _fill(grant, {"default": "DENY"})
    return _written(root)


def _topics(parent: ET.Element, names: Iterable[str]) -> None:
    topics = ET.SubElement(parent, "topics")
    for name in sorted(names):
        ET.SubElement(topics, "topic").text = name


def _document(kind: str) -> ET.Element:
    return ET.Element("dds", {_SCHEMA: _SCHEMAS.format(kind)})


def _fill(parent: ET.Element, texts: dict[str, str]) -> None:
    for name, text in texts.items():
        ET.SubElement(parent, name).text = text


def _written(root: ET.Element) -> str:
    ET.register_namespace("xsi", _SCHEMA[1 : _SCHEMA.index("}")])
    ET.indent(root)
    return ET.tostring(root, "unicode", xml_declaration=False) + "\n"
