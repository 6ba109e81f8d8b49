"""Governance and permissions: the two documents of DDS security, as XML (OMG DDS-SECURITY 1.1)."""

from collections.abc import Iterable
from datetime import datetime
from xml.etree import ElementTree as ET

from edgevox.security.roles import Rights

_SCHEMAS = "http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_{}.xsd"
_SCHEMA = "{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation"
LAST_DOMAIN = 232
"""The last for which DDS has ports."""
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
