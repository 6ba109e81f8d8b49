"""ROS 2's interface types by their names, found among the packages that are sourced."""

import re
from importlib import import_module
from typing import Any, Literal

from edgevox.core.errors import EdgeVoxError

Kind = Literal["msg", "srv", "action"]

_NAME = re.compile(r"([a-z][a-z0-9_]*)/(?:(msg|srv|action)/)?([A-Z][A-Za-z0-9]*)")
_PRIMITIVE = re.compile(
    r"u?int(?:8|16|32|64)|float|double|boolean|octet|byte|char|w?string(?:<\d+>)?"
)
_ARRAY = re.compile(r"(?P<inner>[^<\[]+(?:<\d+>)?)\[(?P<length>\d+)\]")
_SEQUENCE = re.compile(r"sequence<(?P<inner>[^,<]+(?:<\d+>)?)(?:, *(?P<most>\d+))?>")


class InterfaceMissing(EdgeVoxError):
    """A type cannot be imported: its package is not there, or has no such type."""


def interface(name: str, kind: Kind) -> Any:
    """The class of an interface such as ``std_srvs/srv/SetBool``; the middle may be left out.

    Raises `InterfaceMissing` with the reason.
    """
    package, _, bare = full_name(name, kind).split("/")
    try:
        module = import_module(f"{package}.{kind}")
    except ImportError as error:
        raise InterfaceMissing(
            f"{package} cannot be imported ({error}): source the workspace that has it"
        ) from error
    found = getattr(module, bare, None)
    if found is None:
        known = sorted(one for one in dir(module) if one[:1].isupper() and "_" not in one)
        raise InterfaceMissing(f"{package} has no {kind} {bare!r}, only {', '.join(known)}")
    return found


def full_name(name: str, kind: Kind) -> str:
    """The type's name with its middle. Raises `InterfaceMissing` for what names no type."""
    match = _NAME.fullmatch(name)
    if match is None or match[2] not in (None, kind):
        raise InterfaceMissing(f"{name!r} is no type such as package/{kind}/Name")
    return f"{match[1]}/{kind}/{match[3]}"


def fields_of(message: Any) -> dict[str, str]:
    """The fields of a message, or of its class, with their types as IDL writes them."""
    return dict(message.get_fields_and_field_types())


def is_primitive(type_name: str) -> bool:
    """Whether it is a number, a truth or a text."""
    return _PRIMITIVE.fullmatch(type_name) is not None


def is_text(type_name: str) -> bool:
    """Whether it is a text, bounded or not."""
    return type_name.startswith(("string", "wstring"))


def listed(type_name: str) -> tuple[str, int | None, int | None] | None:
    """For a list: the type in it, its fixed length, and the most that it takes; else None."""
    if match := _ARRAY.fullmatch(type_name):
        return match["inner"], int(match["length"]), None
    if match := _SEQUENCE.fullmatch(type_name):
        return match["inner"], None, int(match["most"]) if match["most"] else None
    return None
