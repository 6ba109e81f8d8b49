"""The arguments of a skill: their model, what fits it, and what the words of a sentence become.

Arguments are JSON values, wherever they come from, and each has the type that its skill says: a
whole number is one where a number is asked for; true, "5" and 5.5 are no whole numbers.
"""

import inspect
import json
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError, create_model

from edgevox.agent.skills.failures import impossible, wrong_argument
from edgevox.core.errors import InvalidValue

LARGEST_NUMBER = 2**53
"""Beyond it JSON's numbers are not exact, and no robot can go there."""
_CONFIG = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def arguments_model(function: Callable[..., Any]) -> type[BaseModel]:
    """A model of all parameters but the first, which is the goal."""
    hints = get_type_hints(function, include_extras=True)
    parameters = list(inspect.signature(function).parameters.values())[1:]
    if not parameters:
        return _no_arguments(function.__name__)
    fields: dict[str, Any] = {
        p.name: (hints[p.name], ... if p.default is p.empty else p.default) for p in parameters
    }
    return create_model(f"{function.__name__}_arguments", __config__=_CONFIG, **fields)


@lru_cache
def _no_arguments(name: str) -> type[BaseModel]:
    """The same for every function of this name; most skills are made again for each agent."""
    return create_model(f"{name}_arguments", __config__=_CONFIG)


def check_arguments(
    name: str, model: type[BaseModel], arguments: Mapping[str, Any]
) -> dict[str, Any]:
    """The values that the skill `name` gets. Raises `InvalidValue` naming the first wrong one."""
    try:
        text = json.dumps(dict(arguments))
    except (TypeError, ValueError, RecursionError) as error:
        raise InvalidValue(f"{name}.arguments", arguments, f"JSON values ({error})") from None
    try:
        checked = model.model_validate_json(text)
    except ValidationError as error:
        raise wrong_argument(name, model, error) from None
    return {field: getattr(checked, field) for field in model.model_fields}


def check_numbers(name: str, arguments: Mapping[str, Any]) -> None:
    """Raise `InvalidValue` for the first number that is too large for any skill."""
    for path, number in _numbers(name, arguments):
        if abs(number) > LARGEST_NUMBER:
            expected = f"a number of at most {LARGEST_NUMBER}"
            raise impossible(path, path.split(".")[1], number, expected)


def from_words(model: type[BaseModel], said: Mapping[str, str]) -> dict[str, Any]:
    """Words of a sentence as JSON values of their arguments' types.

    A word that is no such value stays as it was said, for `check_arguments` to refuse by name.
    """
    return {name: _from_word(model, name, word) for name, word in said.items()}


def _from_word(model: type[BaseModel], name: str, word: str) -> Any:
    if name not in model.model_fields:
        return word
    annotation: Any = model.model_fields[name].annotation
    kind: TypeAdapter[Any] = TypeAdapter(annotation)
    try:
        return kind.dump_python(kind.validate_python(word, strict=False), mode="json")
    except ValidationError:
        return word


def _numbers(path: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, int | float):
        yield path, value
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _numbers(f"{path}.{key}", inner)
    elif isinstance(value, list | tuple):
        for index, inner in enumerate(value):
            yield from _numbers(f"{path}.{index}", inner)


def is_number_type(annotation: Any) -> bool:
    """True if this type is a number, or a number or None."""
    either = get_origin(annotation) in (Union, UnionType)
    kinds = set(get_args(annotation) if either else (annotation,)) - {NoneType}
    return bool(kinds) and kinds <= {int, float}
