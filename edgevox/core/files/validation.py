"""What pydantic finds wrong, as an `InvalidValue`: the field, its value and what would be right."""

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from edgevox.core.errors import InvalidValue

Place = tuple[str | int, ...]
"""Where a value is in others: keys of mappings, indices of lists."""

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
    """The first thing that is wrong. `name` says what a place is called.

    `other` is what is expected where an error of pydantic's type needs other words than here.
    """
    first = error.errors(include_url=False)[0]
    said = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    value = None if first["type"] == "missing" else _without_password(first["input"])
    expected = {**_EXPECTED, **other}.get(first["type"], said)
    return InvalidValue(name(first["loc"]), value, expected)


def wrong(place: Place, value: object, expected: str) -> ValidationError:
    """What a validator of a whole mapping raises for a value that is inside of it."""
    message = PydanticCustomError("value_error", "{expected}", {"expected": expected})
    details = InitErrorDetails(type=message, loc=place, input=value)
    return ValidationError.from_exception_data("value", [details])


def dotted(place: Place) -> str:
    """The usual name of a place."""
    return ".".join(map(str, place))


def _without_password(value: object) -> object:
    """A value as it may be shown: what stands before the @ of an address is nobody's business."""
    return re.sub(r"//[^/]*@", "//***@", value) if isinstance(value, str) else value
