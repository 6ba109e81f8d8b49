"""Fields of messages by their path: ``status.battery.percent`` or ``ranges[0]``.

An index may be a name: ``position[name=elbow]`` is the position beside the name "elbow",
``parts[id=arm]`` the part whose id is "arm". ``parts[].id`` is a list, the id of each part.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.ros2.robot_file.messages import (
    LONGEST_LIST,
    fields_of,
    interface,
    is_primitive,
    listed,
    plain,
    with_arguments,
)

LONGEST_TEXT, LONGEST_SHOWN = 200, 50
_PARTS = re.compile(r"(?P<name>[a-z][a-z0-9_]*)(?P<indices>(?:\[[^\[\]]*\])*)(?:\.(?=.)|$)")
_INDEX = re.compile(r"\[(?:(?P<number>\d+)|(?P<key>[a-z][a-z0-9_]*)=(?P<value>[^\[\]]+))?\]")


@dataclass(frozen=True, slots=True)
class FieldType:
    """What stands at a path of messages of a kind."""

    type: str
    """As IDL writes it; a sequence if the path gathers a field of each of several."""
    owner: Any
    """The class of the message whose field it is."""


@lru_cache(4096)
def _split(path: str) -> tuple[tuple[str, tuple[re.Match[str], ...]], ...] | None:
    """The names of a path, each with its indices; None for what is no path."""
    parts, at = [], 0
    while at < len(path):
        part = _PARTS.match(path, at)
        indices = tuple(_INDEX.finditer(part["indices"])) if part else ()
        if part is None or "".join(one[0] for one in indices) != part["indices"]:
            return None
        parts.append((part["name"], indices))
        at = part.end()
    return tuple(parts)


def field_at(kind: Any, path: str, field: str) -> FieldType:
    """What stands at this path of such messages.

    Raises `InvalidValue` naming `field` for a path that is not there.
    """
    several = False
    parts = _split(path) or ((path, ()),)
    for name, indices in parts:
        known = fields_of(kind) if kind is not None else {}
        if name not in known:
            raise InvalidValue(field, path, "a path whose next part is one of " + ", ".join(known))
        owner, type_name = kind, known[name]
        for index in indices:
            type_name = _item_type(type_name, name, index, known, InvalidValue(field, path, ""))
            several |= index[0] == "[]"
        kind = None if is_primitive(type_name) or listed(type_name) else interface(type_name, "msg")
    return FieldType(f"sequence<{type_name}>" if several else type_name, owner)


def _item_type(
    type_name: str,
    name: str,
    index: re.Match[str],
    beside: Mapping[str, str],
    at: InvalidValue,
) -> str:
    """The type of what such an index names in a list."""
    several = listed(type_name)
    if several is None:
        raise InvalidValue(at.field, at.value, f"no index: {name} is one {type_name}")
    if index["key"]:
        lists = {one: kind for one, kind in beside.items() if listed(kind)}
        known = lists if is_primitive(several[0]) else fields_of(interface(several[0], "msg"))
        if index["key"] not in known:
            expected = "an index by one of " + ", ".join(known)
            raise InvalidValue(at.field, at.value, expected)
    return several[0]


def read_path(message: Any, path: str, arguments: Mapping[str, Any] | None = None) -> Any:
    """Return the value at this path; None if a list is shorter, or has no such item.

    `arguments` are values that its indices may name.
    """
    return _read(message, _split(path) or (), arguments or {})


def _read(
    message: Any,
    parts: Sequence[tuple[str, tuple[re.Match[str], ...]]],
    arguments: Mapping[str, Any],
) -> Any:
    if not parts:
        return plain(message)
    (name, indices), *rest = parts
    value = getattr(message, name)
    for index in indices:
        if index[0] == "[]":
            found = (_read(one, rest, arguments) for one in value[:LONGEST_LIST])
            return [one for one in found if one is not None]
        value = _item(message, value, index, arguments)
        if value is None:
            return None
    return _read(value, rest, arguments)


def _item(message: Any, several: Any, index: re.Match[str], arguments: Mapping[str, Any]) -> Any:
    """The item of a list that an index names; None if there is none."""
    if index["number"]:
        at = int(index["number"])
        return several[at] if at < len(several) else None
    wanted = str(with_arguments(index["value"], arguments))
    own = len(several) and hasattr(several[0], index["key"])
    keys = (
        [getattr(one, index["key"]) for one in several]
        if own
        else getattr(message, index["key"], ())
    )
    pairs = zip(keys, several, strict=False)
    return next((one for its, one in pairs if str(plain(its)) == wanted), None)


def owner_of(message: Any, path: str) -> Any:
    """The class of the message whose field stands at this path of a message's class."""
    return field_at(message, path, "").owner


def brief(value: Any) -> Any:
    """Return a message's value as JSON, with only the beginning of each text and list.

    Writing out a value of 10 MB would keep every thread from its work for seconds, even a stop's.
    """
    value = plain(value)
    if isinstance(value, str):
        return value[:LONGEST_TEXT]
    if isinstance(value, float):
        return value if isfinite(value) else None
    if hasattr(value, "get_fields_and_field_types"):
        return {name: brief(getattr(value, name)) for name in fields_of(value)}
    if hasattr(value, "__len__"):
        return [brief(one) for one in value[:LONGEST_SHOWN]]
    return value
