"""The arguments of a skill in the file: their model, what they mean in a request, samples."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, create_model

from edgevox.agent.skills import OneOf
from edgevox.ros2.robot_file.robot_file_format import Argument
from edgevox.ros2.robot_file.step_format import Meaning

LONGEST_TEXT = 500
_TYPES: Mapping[str, type] = {"number": float, "integer": int, "boolean": bool, "text": str}
_FAR = 2**53


def arguments_model(name: str, arguments: Mapping[str, Argument]) -> type[BaseModel]:
    """The model that a call's arguments are held to."""
    fields: dict[str, Any] = {
        key: (_annotated(one), ... if one.default is None else one.default)
        for key, one in arguments.items()
    }
    config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
    return create_model(f"{name}_arguments", __config__=config, **fields)


def meanings(arguments: Mapping[str, Argument], values: Mapping[str, Any]) -> dict[str, Any]:
    """What goes into the request: of a choice what its word stands for, of others the value."""
    return {name: _meaning(arguments[name], value) for name, value in values.items()}


def samples(arguments: Mapping[str, Argument]) -> Iterator[tuple[str, dict[str, Meaning]]]:
    """Values that a request has to take, and the argument that is tried with each: its extremes."""
    every = {
        name: [_meaning(one, value) for value in _samples(one)] for name, one in arguments.items()
    }
    usual = {name: values[0] for name, values in every.items()}
    yield "", usual
    for name, values in every.items():
        yield from ((name, {**usual, name: value}) for value in values)


def _annotated(one: Argument) -> Any:
    about = f"{one.description} ({one.unit})" if one.unit else one.description
    if one.type == "choice":
        words = OneOf(tuple(one.meanings), one.aliases, names=one.names)
        return Annotated[str, words, Field(description=about)]
    bounds: dict[str, Any] = {"ge": one.min, "le": one.max} if one.type in _NUMBERS else {}
    if one.type == "text":
        bounds = {"max_length": LONGEST_TEXT}
    return Annotated[_TYPES[one.type], Field(description=about or None, **bounds)]


_NUMBERS = ("number", "integer")


def _meaning(one: Argument, value: Any) -> Any:
    if one.type == "choice":
        return one.meanings[value]
    return value if one.times is None else value * one.times


def _samples(one: Argument) -> list[Any]:
    if one.type == "choice":
        return list(one.meanings)
    if one.type == "boolean":
        return [True, False]
    if one.type == "text":
        return ["text"]
    low = -_FAR if one.min is None else one.min
    high = _FAR if one.max is None else one.max
    if one.type == "integer":
        return [int(low), int(high)]
    # A number that is no whole one shows a field that takes only those.
    return [float(low), float(high), low + (high - low) / 3 + 0.01 * (high > low)]
