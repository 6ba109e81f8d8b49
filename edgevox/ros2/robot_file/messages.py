"""ROS 2's interface types by their names, found among the packages that are sourced.

Reads fields out of messages by their path: ``status.battery.percent`` or ``ranges[0]``.

Fills a message from a template: the values of its fields by name, `{argument}` where one goes.

    pose: {position: {x: "{x}", y: 0.0}}

A text that is nothing but an argument takes the argument's value, whatever its type; in a longer
one the value is written out. Of a `builtin_interfaces/Time` the word ``now`` is the node's time.
"""

import math
import re
from collections.abc import Callable, Mapping
from importlib import import_module
from math import isfinite
from typing import Any, Literal

from edgevox.core.errors import EdgeVoxError, InvalidValue

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
    """Return whether it is a number, a truth or a text."""
    return _PRIMITIVE.fullmatch(type_name) is not None


def is_text(type_name: str) -> bool:
    """Return whether it is a text, bounded or not."""
    return type_name.startswith(("string", "wstring"))


def listed(type_name: str) -> tuple[str, int | None, int | None] | None:
    """Return a list's item type, fixed length and greatest length; None for other types."""
    if match := _ARRAY.fullmatch(type_name):
        return match["inner"], int(match["length"]), None
    if match := _SEQUENCE.fullmatch(type_name):
        return match["inner"], None, int(match["most"]) if match["most"] else None
    return None


LONGEST_TEXT, LONGEST_SHOWN = 200, 50
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
    """Return the value at this path; None if a list is shorter."""
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
    """Return a message's value as JSON, with only the beginning of each text and list.

    Writing out a value of 10 MB would keep every thread from its work for seconds, even a stop's.
    """
    value = _plain(value)
    if isinstance(value, str):
        return value[:LONGEST_TEXT]
    if isinstance(value, float):
        return value if isfinite(value) else None
    if hasattr(value, "get_fields_and_field_types"):
        return {name: brief(getattr(value, name)) for name in fields_of(value)}
    if hasattr(value, "__len__"):
        return [brief(one) for one in value[:LONGEST_SHOWN]]
    return value


LONGEST_LIST = 10_000
NOW = "now"
_ARGUMENT = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_WHOLE = re.compile(r"(u?)int(\d+)")
_TIME = "builtin_interfaces/Time"
_LARGEST_FLOAT = 3.4028235e38


def arguments_in(template: Any) -> frozenset[str]:
    """The arguments that a template names."""
    if isinstance(template, str):
        return frozenset(_ARGUMENT.findall(template))
    inner = template.values() if isinstance(template, Mapping) else template
    if isinstance(inner, str | int | float | None):
        return frozenset()
    return frozenset().union(*(arguments_in(one) for one in inner))


class Filling:
    """Fills messages; `now` gives the time message for `NOW`."""

    def __init__(self, now: Callable[[], Any]) -> None:
        self._now = now

    def fill(self, message: Any, template: Mapping[str, Any], arguments: Mapping[str, Any]) -> Any:
        """The message, with its fields set. Raises `InvalidValue` naming the field."""
        self._fill(message, template, arguments, "")
        return message

    def _fill(self, message: Any, values: Any, arguments: Mapping[str, Any], path: str) -> None:
        if not isinstance(values, Mapping):
            raise InvalidValue(path, values, "a mapping, field to value")
        known = fields_of(message)
        for name, value in values.items():
            where = f"{path}.{name}" if path else str(name)
            if name not in known:
                raise InvalidValue(where, value, "a field that is one of " + ", ".join(known))
            inner = getattr(message, name)
            setattr(message, name, self._value(known[name], inner, value, arguments, where))

    def _value(
        self,
        type_name: str,
        before: Any,
        value: Any,
        arguments: Mapping[str, Any],
        path: str,
    ) -> Any:
        value = with_arguments(value, arguments)
        if is_primitive(type_name):
            return primitive(type_name, value, path)
        if listed(type_name):
            return self._list(type_name, value, arguments, path)
        if type_name == _TIME and value == NOW:
            return self._now()
        self._fill(before, value, arguments, path)
        return before

    def _list(
        self, type_name: str, value: Any, arguments: Mapping[str, Any], path: str
    ) -> list[Any]:
        inner, length, most = listed(type_name) or (type_name, None, None)
        most = min(most or LONGEST_LIST, LONGEST_LIST)
        if not isinstance(value, list) or len(value) > most:
            raise InvalidValue(path, value, f"a list of at most {most}")
        if length is not None and len(value) != length:
            raise InvalidValue(path, value, f"a list of {length}")
        return [
            self._value(inner, _empty(inner), one, arguments, f"{path}[{index}]")
            for index, one in enumerate(value)
        ]


def _empty(type_name: str) -> Any:
    return None if is_primitive(type_name) else interface(type_name, "msg")()


def with_arguments(value: Any, arguments: Mapping[str, Any]) -> Any:
    """A value of a template; only a text names arguments."""
    if not isinstance(value, str):
        return value
    if match := _ARGUMENT.fullmatch(value):
        return arguments[match[1]]
    return _ARGUMENT.sub(lambda found: str(arguments[found[1]]), value)


def primitive(type_name: str, value: Any, path: str) -> Any:
    """A value as a field of this type takes it. Raises `InvalidValue` naming `path`."""
    if is_text(type_name):
        if not isinstance(value, str):
            raise InvalidValue(path, value, "a text")
        return value
    if type_name == "boolean":
        if not isinstance(value, bool):
            raise InvalidValue(path, value, "true or false")
        return value
    if type_name in ("float", "double"):
        return _real(type_name, value, path)
    return _whole(type_name, value, path)


def _real(type_name: str, value: Any, path: str) -> float:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    most = _LARGEST_FLOAT if type_name == "float" else math.inf
    if not number or not math.isfinite(value) or abs(value) > most:
        raise InvalidValue(path, value, f"a number that fits {type_name}")
    return float(value)


def _whole(type_name: str, value: Any, path: str) -> Any:
    match = _WHOLE.fullmatch(type_name)
    unsigned, bits = (match[1] == "u", int(match[2])) if match else (True, 8)
    low, high = (0, 2**bits - 1) if unsigned else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidValue(path, value, f"a whole number from {low} to {high} ({type_name})")
    return bytes([value]) if type_name in ("octet", "byte") else value
