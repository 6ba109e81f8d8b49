"""Conversion of pydantic's errors to `InvalidValue`: the field, its value and the expectation."""

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from edgevox.core.errors import InvalidValue

Place = tuple[str | int, ...]
"""The way to a value inside others: keys of mappings, indices of lists."""

_EXPECTED = {
    "missing": "a value",
    "extra_forbidden": "no such key",
    **dict.fromkeys(("model_type", "dataclass_type", "dict_type"), "a mapping, key to value"),
}


def explain(
    error: ValidationError,
    name: Callable[[Place], str],
    other: Mapping[str, str] = MappingProxyType({}),
) -> InvalidValue:
    """The first problem as an `InvalidValue`. `name` returns the name of a place.

    `other` maps pydantic's error types to expectations that replace those of this module.
    """
    first = error.errors(include_url=False)[0]
    said = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    value = None if first["type"] == "missing" else _without_password(first["input"])
    expected = {**_EXPECTED, **other}.get(first["type"], said)
    return InvalidValue(name(first["loc"]), value, expected)


def wrong(place: Place, value: object, expected: str) -> ValidationError:
    """The error that a validator of a whole mapping raises for a value inside it."""
    message = PydanticCustomError("value_error", "{expected}", {"expected": expected})
    details = InitErrorDetails(type=message, loc=place, input=value)
    return ValidationError.from_exception_data("value", [details])


def dotted(place: Place) -> str:
    """The name of a place, its parts joined by dots."""
    return ".".join(map(str, place))


def _without_password(value: object) -> object:
    """A value that may be shown: without the part of an address before its @."""
    return re.sub(r"//[^/]*@", "//***@", value) if isinstance(value, str) else value
