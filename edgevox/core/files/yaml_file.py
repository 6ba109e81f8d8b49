"""A reader of YAML from people and from outside, bounded in size even with aliases."""

import re
from collections.abc import Collection, Iterator, Mapping
from copy import copy
from functools import cached_property, reduce
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES
from edgevox.core.files.validation import Place, dotted, explain_all, names_a_kind, told

M = TypeVar("M", bound=BaseModel)

MOST_OPEN = 200
LONGEST_NUMBER = 100
"""Length in characters: YAML has numbers to the base of 60, whose powers take minutes."""
_MERGE = "tag:yaml.org,2002:merge"
_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
_EXPECTED = {
    **dict.fromkeys(
        ("model_type", "dataclass_type", "dict_type"),
        "a mapping, key to value; YAML reads no, off, yes and on as truth: quote words",
    ),
    "invalid_key": "a key that is a text",
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "a text",
    "bool_type": "true or false",
    "float_parsing": "a number",
    "int_parsing": "a whole number",
    "bool_parsing": "true or false",
}
"""Expectations in words for people who write YAML, not Python."""


class _KeyTwice(Exception):
    def __init__(self, key: object, first: int, again: int) -> None:
        super().__init__(key)
        self.key = key
        self.expected = f"each key once in its mapping; line {again} repeats line {first}"


class _EachKeyOnce(yaml.SafeLoader):
    """A safe loader that refuses repeated keys.

    The usual loader silently takes the second of two equal keys. It also uses unbounded time and
    memory for merges (`<<`) that multiply, and raises errors of its own for a value that does not
    fit its tag, such as `!!int ""`.
    """

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._pairs: dict[int, int] = {}
        self._merged = 0

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        kind = node.tag.rpartition(":")[2]
        if node.tag in _NUMBERS and len(node.value) > LONGEST_NUMBER:
            said = f"a number of more than {LONGEST_NUMBER} characters"
            raise yaml.constructor.ConstructorError(None, None, said, node.start_mark)
        try:
            return super().construct_object(node, deep)
        except (ArithmeticError, AttributeError, LookupError):
            raise yaml.constructor.ConstructorError(
                None, None, f"this is no {kind}", node.start_mark
            ) from None

    def compose_mapping_node(self, anchor: dict[Any, yaml.Node]) -> yaml.MappingNode:
        # Check the mapping as it is written: a key may override a merged one (`<<`).
        node = super().compose_mapping_node(anchor)
        lines: dict[Any, int] = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and key.tag != _MERGE:
                value, line = self.construct_object(key), key.start_mark.line + 1
                if value in lines:
                    raise _KeyTwice(value, lines[value], line)
                lines[value] = line
        self._count_merged(node)
        return node

    def _count_merged(self, node: yaml.MappingNode) -> None:
        """Refuse merges that multiply: each mapping may merge several that merge several."""
        values = [value for key, value in node.value if key.tag == _MERGE]
        parts = [one.value if isinstance(one, yaml.SequenceNode) else [one] for one in values]
        merged = sum(self._pairs.get(id(part), 0) for inner in parts for part in inner)
        self._pairs[id(node)] = len(node.value) + merged
        self._merged += merged
        if self._merged > LARGEST_TEXT_BYTES:
            said = "merges that multiply"
            raise yaml.constructor.ConstructorError(None, None, said, node.start_mark)


def parse_yaml(text: str, name: str) -> Any:
    """The values of a YAML text; `name` is the file's name in messages."""
    if _open_at_once(text) > MOST_OPEN:
        raise InvalidValue(
            name, text[:200], f"valid YAML (at most {MOST_OPEN} brackets within each other)"
        )
    try:
        data = yaml.load(text, _EachKeyOnce)  # noqa: S506 - it is a safe loader
        if _weight(data, {}) > LARGEST_TEXT_BYTES:
            raise InvalidValue(name, text[:200], "aliases that do not multiply")
    except _KeyTwice as error:
        raise InvalidValue(name, error.key, error.expected) from None
    except yaml.MarkedYAMLError as error:
        raise _no_yaml(error, text, name) from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InvalidValue(name, text[:200], f"valid YAML ({reason[:300]})") from None
    return data


def _no_yaml(error: yaml.MarkedYAMLError, text: str, name: str) -> InvalidValue:
    """The error of a text that is no YAML, at the line where its reader gave up."""
    mark = error.problem_mark or error.context_mark
    lines = text.splitlines()
    if mark is None or mark.line >= len(lines):
        return InvalidValue(name, text[:200], f"valid YAML ({error.problem or error.context})")
    line, at = lines[mark.line], mark.column
    advice = "; quote a text with any of { } [ ] , # or a colon" if _SIGNS.search(line) else ""
    shown = line[max(0, at - 60) : at + 60].strip()
    reason = f"valid YAML ({error.problem}, column {at + 1}){advice}"
    return InvalidValue(f"{name}:{mark.line + 1}", shown, reason)


_SIGNS = re.compile(r"[{}\[\],#]|: .*:")
"""Signs that mean something in YAML."""


def _open_at_once(text: str) -> int:
    """Largest number of open brackets: YAML's reader needs unbounded time for many.

    Brackets in texts and comments count as well, since most of them are closed.
    """
    opened = most = 0
    for bracket in re.findall(r"[\[{}\]]", text):
        opened = opened + 1 if bracket in "[{" else max(0, opened - 1)
        most = max(most, opened)
    return most


def _weight(node: Any, known: dict[int, int]) -> int:
    """Number of values with every alias written out; aliases can make a small file explode."""
    if id(node) not in known:
        inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
        known[id(node)] = 1 + sum(_weight(one, known) for one in inner)
    return known[id(node)]


class YamlFile:
    """The values of a YAML text, read as models; errors name file, line and field.

    `tags` are kinds of a list's entries, which pydantic puts into a place after the index.
    """

    def __init__(self, text: str, name: str, tags: Collection[str] = ()) -> None:
        self.data, self.name = parse_yaml(text, name), name
        self._text, self._tags = text, tags
        self._whole = self.data
        self.at: Place = ()
        """The place of `data` in the whole file."""

    def part(self, *place: str | int) -> "YamlFile":
        """The part at this place as a file of its own; its errors name places in the whole file."""
        part = copy(self)
        part.at = (*self.at, *place)
        part.data = reduce(_inside, place, self.data)
        return part

    def read(self, model: type[M], data: Any, place: Place = ()) -> M:
        """Read `data`, which stands at this place of the file, as a model."""
        try:
            return model.model_validate(data)
        except ValidationError as error:
            raise self.explain(error, place) from None

    def explain(self, error: ValidationError, place: Place) -> InvalidValue:
        """The error to raise for a validation error in this place."""
        if self._whole is None:
            return InvalidValue(self.name, "", "a mapping, key to value: the file is empty")
        return told(explain_all(error, lambda inner: self.field((*place, *inner)), _EXPECTED))

    def wrong(self, place: Place, value: object, expected: str) -> InvalidValue:
        """The error to raise for a value at this place that no model can judge alone."""
        return InvalidValue(self.field(place), value, expected)

    def field(self, place: Place) -> str:
        """The name of a place: the file, the line, and the way to it."""
        place = tuple(self._in_the_file((*self.at, *place)))
        return f"{self.name}:{self._line(place)}: {dotted(place)}" if place else self.name

    def _in_the_file(self, place: Place) -> Iterator[str | int]:
        """The place without pydantic's additions: tags, marks of keys, indices of non-lists."""
        data, before = self._whole, None
        for part in place:
            tag = (part in self._tags and isinstance(before, int)) or (
                names_a_kind(part) and not (isinstance(data, Mapping) and part in data)
            )
            index = isinstance(part, int) and isinstance(data, Mapping) and part not in data
            before = part
            if tag or index or part == "[key]":
                continue
            yield part
            data = _inside(data, part)

    @cached_property
    def _root(self) -> yaml.Node | None:
        """The parsed nodes, which know their lines; parsed again when a line is needed."""
        return yaml.compose(self._text, yaml.SafeLoader)

    def _line(self, place: Place) -> int:
        """The line of a place, from 1, or of the last existing part of the way to it."""
        node, line = self._root, 0
        for part in place:
            if isinstance(node, yaml.MappingNode):
                found = [pair for pair in node.value if pair[0].value == str(part)]
            elif isinstance(node, yaml.SequenceNode) and isinstance(part, int):
                found = [(one, one) for one in node.value[part : part + 1]]
            else:
                break
            if not found:
                break
            line, node = found[0][0].start_mark.line, found[0][1]
        return int(line) + 1


def _inside(data: Any, part: str | int) -> Any:
    try:
        return data[part]
    except (TypeError, LookupError):
        return None


def value_key(value: object) -> str:
    """A value as a key in YAML: `true`, `3`, `0.5`, or a text as it is."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)
