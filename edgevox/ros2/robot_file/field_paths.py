"""Reads fields out of messages by their path: ``status.battery.percent`` or ``ranges[0]``."""

import re
from math import isfinite
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.ros2.robot_file.interfaces import fields_of, interface, is_primitive, listed

LONGEST_TEXT, LONGEST_LIST = 200, 50
_PART = re.compile(r"([a-z][a-z0-9_]*)((?:\[\d+\])*)")
_INDEX = re.compile(r"\[(\d+)\]")


def check_path(kind: Any, path: str, field: str) -> str:
    """The type of what stands at this path of such messages.

    Raises `InvalidValue` naming `field` for a path that is not there.
    """
    for part in path.split("."):
        match = _PART.fullmatch(part)
        known = fields_of(kind) if kind is not None else {}
        if match is None or match[1] not in known:
            raise InvalidValue(field, path, "a path whose next part is one of " + ", ".join(known))
        type_name = known[match[1]]
        for _ in _INDEX.findall(match[2]):
            several = listed(type_name)
            if several is None:
                raise InvalidValue(field, path, f"no index: {match[1]} is one {type_name}")
            type_name = several[0]
        kind = None if is_primitive(type_name) or listed(type_name) else interface(type_name, "msg")
    return type_name


def read_path(message: Any, path: str) -> Any:
    """What stands at this path; None where a list is shorter."""
    for part in path.split("."):
        name, *_ = part.partition("[")
        message = getattr(message, name)
        for index in _INDEX.findall(part):
            if int(index) >= len(message):
                return None
            message = message[int(index)]
    return _plain(message)


def _plain(value: Any) -> Any:
    """A number, a truth or a text as JSON has it; others as they are."""
    if isinstance(value, bytes):
        return value[0] if len(value) == 1 else list(value)
    return value.item() if getattr(value, "shape", None) == () else value


def brief(value: Any) -> Any:
    """A value of a message as JSON has it, with the beginning of each text and list in it.

    To write out all of what may be 10 MB keeps every thread from its work for seconds, that of a
    stop, too.
    """
    value = _plain(value)
    if isinstance(value, str):
        return value[:LONGEST_TEXT]
    if isinstance(value, float):
        return value if isfinite(value) else None
    if hasattr(value, "get_fields_and_field_types"):
        return {name: brief(getattr(value, name)) for name in fields_of(value)}
    if hasattr(value, "__len__"):
        return [brief(one) for one in value[:LONGEST_LIST]]
    return value
