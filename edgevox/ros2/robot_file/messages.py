"""ROS 2's interface types by their names, found among the packages that are sourced.

Fills a message from a template: the values of its fields by name, `{argument}` where one goes.

    pose: {position: {x: "{x}", y: 0.0}}

A text that is nothing but an argument takes the argument's value, whatever its type; in a longer
one the value is written out. Of a `builtin_interfaces/Time` the word ``now`` is the node's time.
A text in capitals stands for a constant of the message: ``BLINK``, where a number is expected.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Literal

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.validation import is_number
from edgevox.core.files.yaml_file import value_key

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
            f"{package} cannot be imported ({error}): source the workspace that has it, "
            "or build it with edgevox interfaces"
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


def plain(value: Any) -> Any:
    """A number, a truth or a text as JSON has it; others as they are."""
    if isinstance(value, bytes):
        return value[0] if len(value) == 1 else list(value)
    return value.item() if getattr(value, "shape", None) == () else value


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


_CONSTANT = re.compile(r"[A-Z][A-Z0-9_]*")


def constants_of(kind: Any) -> dict[str, Any]:
    """The constants of a message's class, by their names."""
    names = type(kind).__prepare__("", ()) if kind is not None else {}
    found = {name: getattr(kind, name, None) for name in names if _CONSTANT.fullmatch(name)}
    return {
        n: plain(one)
        for n, one in found.items()
        if isinstance(one, bool | int | float | str | bytes)
    }


def constant(kind: Any, value: Any) -> Any:
    """The value of the constant of this name; of anything else, the value as it is."""
    if not isinstance(value, str) or not _CONSTANT.fullmatch(value):
        return value
    return constants_of(kind).get(value, value)


class Converted(float):
    """A number that is the result of a conversion: it is rounded where a whole one is needed."""

    def __str__(self) -> str:
        return value_key(float(self))

    def __format__(self, spec: str) -> str:
        return str(self) if not spec else float(self).__format__(spec)


def converted(value: Any, times: float | None, plus: float | None) -> Any:
    """A number multiplied by `times`, plus `plus`; anything is itself where both are None."""
    if times is None and plus is None:
        return value
    return Converted(value * (1.0 if times is None else times) + (plus or 0.0))


LONGEST_LIST = 10_000
NOW = "now"
_ARGUMENT = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_WHOLE = re.compile(r"(u?)int(\d+)")
_TIME, _DURATION = "builtin_interfaces/Time", "builtin_interfaces/Duration"
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

    def fill(
        self, message: Any, template: Mapping[str, Any] | str, arguments: Mapping[str, Any]
    ) -> Any:
        """The message, with its fields set. Raises `InvalidValue` naming the field."""
        self._fill(message, with_arguments(template, arguments), arguments, "")
        return message

    def _fill(self, message: Any, values: Any, arguments: Mapping[str, Any], path: str) -> None:
        if not isinstance(values, Mapping):
            raise InvalidValue(path, values, "a mapping, field to value")
        known = fields_of(message)
        for name, value in values.items():
            where = f"{path}.{name}" if path else str(name)
            if name not in known:
                expected = "a field that is one of " + ", ".join(known) if known else "no field"
                raise InvalidValue(where, value, expected)
            place = _Place(known[name], getattr(message, name), type(message), where)
            setattr(message, name, self._value(place, value, arguments))

    def _value(self, place: "_Place", value: Any, arguments: Mapping[str, Any]) -> Any:
        value = with_arguments(value, arguments)
        if is_primitive(place.type):
            return primitive(place.type, value, place.path, place.owner)
        if listed(place.type):
            return self._list(place, value, arguments)
        if place.type == _TIME and value == NOW:
            return self._now()
        if place.type == _DURATION and is_number(value):
            value = _seconds(value, place.path)
        self._fill(place.before, value, arguments, place.path)
        return place.before

    def _list(self, place: "_Place", value: Any, arguments: Mapping[str, Any]) -> list[Any]:
        path = place.path
        inner, length, most = listed(place.type) or (place.type, None, None)
        most = min(most or LONGEST_LIST, LONGEST_LIST)
        if not isinstance(value, list) or len(value) > most:
            raise InvalidValue(path, value, f"a list of at most {most}")
        if length is not None and len(value) != length:
            raise InvalidValue(path, value, f"a list of {length}")
        return [
            self._value(
                _Place(inner, _empty(inner), place.owner, f"{path}[{index}]"), one, arguments
            )
            for index, one in enumerate(value)
        ]


@dataclass(frozen=True, slots=True)
class _Place:
    """A field to be filled: its type, what is in it, the message's class, and its path."""

    type: str
    before: Any
    owner: Any
    path: str


def _seconds(value: float, path: str) -> Mapping[str, int]:
    """The fields of a duration of so many seconds."""
    if not math.isfinite(value) or abs(value) >= 2**31:
        raise InvalidValue(path, value, "a number of seconds")
    sec = math.floor(value)
    return {"sec": sec, "nanosec": min(999_999_999, round((value - sec) * 1e9))}


def _empty(type_name: str) -> Any:
    return None if is_primitive(type_name) else interface(type_name, "msg")()


def with_arguments(value: Any, arguments: Mapping[str, Any]) -> Any:
    """A value of a template; only a text names arguments."""
    if not isinstance(value, str):
        return value
    if match := _ARGUMENT.fullmatch(value):
        return arguments[match[1]]
    return _ARGUMENT.sub(lambda found: str(arguments[found[1]]), value)


def primitive(type_name: str, value: Any, path: str, owner: Any = None) -> Any:
    """A value as a field of this type takes it; `owner` is the class that has its constants.

    Raises `InvalidValue` naming `path`.
    """
    value = constant(owner, value)
    if is_text(type_name):
        if not isinstance(value, str):
            raise InvalidValue(path, value, "a text")
        return value
    if type_name == "boolean":
        if not isinstance(value, bool):
            raise InvalidValue(path, value, "true or false")
        return value
    if isinstance(value, str) and (known := constants_of(owner)):
        names = ", ".join(name for name, one in known.items() if not isinstance(one, str))
        raise InvalidValue(path, value, f"a number ({type_name}), or a constant: {names}")
    if type_name in ("float", "double"):
        return _real(type_name, value, path)
    return _whole(type_name, value, path)


def _real(type_name: str, value: Any, path: str) -> float:
    most = _LARGEST_FLOAT if type_name == "float" else math.inf
    if not is_number(value) or not math.isfinite(value) or abs(value) > most:
        raise InvalidValue(path, value, f"a number that fits {type_name}")
    return float(value)


def _whole(type_name: str, value: Any, path: str) -> Any:
    if isinstance(value, Converted) and math.isfinite(value):
        value = round(value)
    match = _WHOLE.fullmatch(type_name)
    unsigned, bits = (match[1] == "u", int(match[2])) if match else (True, 8)
    low, high = (0, 2**bits - 1) if unsigned else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidValue(path, value, f"a whole number from {low} to {high} ({type_name})")
    return bytes([value]) if type_name in ("octet", "byte") else value
