"""Fills a message from a template: the values of its fields by name, `{argument}` where one goes.

    pose: {position: {x: "{x}", y: 0.0}}

A text that is nothing but an argument takes the argument's value, whatever its type; in a longer
one the value is written out. Of a `builtin_interfaces/Time` the word ``now`` is the node's time.
"""

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.ros2.robot_file.interfaces import fields_of, interface, is_primitive, is_text, listed

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
