"""Comparisons of a value with what a scenario says of it."""

import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from edgevox.core.files.json_reader import is_number


class Missing:
    """What is found where a path leads nowhere: it is not even null."""

    def __repr__(self) -> str:
        return "missing"


MISSING = Missing()
_ROUNDING = 1e-9
_LISTS = (list, tuple)

Number = Annotated[float, Field(allow_inf_nan=False)]
Text = Annotated[str, Field(min_length=1, max_length=500)]


def _pattern(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise ValueError(f"a regular expression ({error})") from None
    return text


class Compare(BaseModel):
    """Comparisons with one value, which must all be true. A plain value means `equals`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    equals: Any = Field(None, description="the same value")
    differs: Any = Field(None, description="any other value")
    near: Number | tuple[Number, ...] | None = Field(
        None, description="a number, or a list of them, within `by` of each"
    )
    by: Annotated[Number, Field(ge=0)] | None = Field(
        None, description="largest distance from `near`"
    )
    above: Number | None = Field(None, description="a number larger than this")
    below: Number | None = Field(None, description="a number smaller than this")
    contains: Text | None = Field(
        None, description="a text with this in it, in any case, or a list or object with this entry"
    )
    matches: Annotated[Text, AfterValidator(_pattern)] | None = Field(
        None, description="a text in which this regular expression is found"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not self.model_fields_set:
            raise ValueError("at least one of " + ", ".join(Compare.model_fields))
        if (self.near is None) != (self.by is None):
            raise ValueError("near and by together")
        return self

    def holds(self, value: Any) -> bool:
        """Whether all of it is true of this value."""
        return all(_TESTS[name](self, value) for name in self.model_fields_set if name != "by")

    def __str__(self) -> str:
        given = [name for name in _SAYS if name in self.model_fields_set]
        return " and ".join(_SAYS[name](self) for name in given)


def _near(compare: Compare, value: Any) -> bool:
    if not isinstance(compare.near, tuple):
        return _close(value, compare.near, compare.by)
    if not isinstance(value, _LISTS) or len(value) != len(compare.near):
        return False
    return all(_close(one, to, compare.by) for one, to in zip(value, compare.near, strict=True))


def _close(value: Any, to: float | None, by: float | None) -> bool:
    return (
        is_number(value) and to is not None and by is not None and abs(value - to) <= by + _ROUNDING
    )


def _contains(compare: Compare, value: Any) -> bool:
    wanted = compare.contains or ""
    if isinstance(value, str):
        return wanted.casefold() in value.casefold()
    return isinstance(value, (*_LISTS, Mapping)) and wanted in value


_SAYS: Mapping[str, Callable[[Compare], str]] = {
    "equals": lambda compare: f"= {compare.equals!r}",
    "differs": lambda compare: f"not {compare.differs!r}",
    "near": lambda compare: f"= {compare.near} ± {compare.by:g}",
    "above": lambda compare: f"> {compare.above:g}",
    "below": lambda compare: f"< {compare.below:g}",
    "contains": lambda compare: f"with {compare.contains!r}",
    "matches": lambda compare: f"like {compare.matches!r}",
}
_TESTS: Mapping[str, Callable[[Compare, Any], bool]] = {
    "equals": lambda compare, value: value == compare.equals,
    "differs": lambda compare, value: value != compare.differs,
    "near": _near,
    "above": lambda compare, value: is_number(value) and value > compare.above,
    "below": lambda compare, value: is_number(value) and value < compare.below,
    "contains": _contains,
    "matches": lambda compare, value: (
        isinstance(value, str) and re.search(str(compare.matches), value) is not None
    ),
}


def _equals_if_plain(value: Any) -> Any:
    return value if isinstance(value, Mapping) else {"equals": value}


def _contains_if_plain(value: Any) -> Any:
    return {"contains": value} if isinstance(value, str) else value


_Plain = str | float | bool | list[Any] | None

Value = Annotated[
    Compare, BeforeValidator(_equals_if_plain, json_schema_input_type=Compare | _Plain)
]
"""A comparison, or a plain value that must be equal."""
Words = Annotated[
    Compare, BeforeValidator(_contains_if_plain, json_schema_input_type=Compare | str)
]
"""A comparison of a text, or a plain text that must be in it."""


def look_up(path: str, data: Mapping[str, Any]) -> Any:
    """The value at a path such as ``pose.x`` or ``cubes.0.name``, or `MISSING`."""
    value: Any = data
    for part in path.split("."):
        if isinstance(value, Mapping) and part in value:
            value = value[part]
        elif isinstance(value, _LISTS) and part.isdecimal() and int(part) < len(value):
            value = value[int(part)]
        else:
            return MISSING
    return value
