"""Reads scenario files; what is wrong in one is said by field and line."""

from collections.abc import Sequence
from pathlib import Path

import yaml
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import read_text
from edgevox.core.yaml_file import parse_yaml
from edgevox.scenario.model import Scenario
from edgevox.scenario.steps import STEPS

Place = Sequence[str | int]


def load_scenario(file: Path) -> Scenario:
    """The scenario in a file. Raises `InvalidValue` naming the field, its line, what is wrong."""
    return parse_scenario(read_text(file, "scenario"), file.name)


def parse_scenario(text: str, name: str) -> Scenario:
    """As `load_scenario`; `name` is the file's name in messages."""
    data = parse_yaml(text, name)
    if not isinstance(data, dict):
        raise InvalidValue(name, data, "a mapping with steps")
    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        raise _explain(error, text, name) from None


def _explain(error: ValidationError, text: str, name: str) -> InvalidValue:
    first = error.errors(include_url=False)[0]
    place = _in_the_file(first["loc"])
    field = ".".join(str(part) for part in place)
    at = f"{name}:{_line(text, place)}"
    return InvalidValue(
        f"{at}: {field}" if field else at,
        None if first["type"] == "missing" else first["input"],
        _expected(first),
    )


def _expected(error: ErrorDetails) -> str:
    match error["type"]:
        case "missing":
            return "a value"
        case "extra_forbidden":
            return "no such key"
        case "model_type" | "model_attributes_type" | "dict_type":
            return "a mapping, key to value; YAML reads no, off, yes and on as truth: quote words"
        case _:
            message = error["msg"].removeprefix("Value error, ")
            return message.removeprefix("Input should be ")


def _in_the_file(location: Sequence[str | int]) -> Place:
    """A location without the tag that pydantic puts after the index of a step."""
    place = list(location)
    if len(place) > 2 and place[0] == "steps" and place[2] in STEPS:
        del place[2]
    return place


def _line(text: str, place: Place) -> int:
    """The line, from 1, of what is at this place, or of the last thing on the way that is there."""
    node = yaml.compose(text, yaml.SafeLoader)
    line = 0
    for part in place:
        if isinstance(node, yaml.MappingNode):
            found = [(key, value) for key, value in node.value if key.value == str(part)]
            if not found:
                break
            line, node = found[0][0].start_mark.line, found[0][1]
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int):
            node = node.value[part]
            line = node.start_mark.line
        else:
            break
    return int(line) + 1
