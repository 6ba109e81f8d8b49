"""Reads YAML that people write and others send: bounded in size, also with aliases."""

from typing import Any

import yaml

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import LARGEST_TEXT_BYTES

_MERGE = "tag:yaml.org,2002:merge"


class _KeyTwice(Exception):
    def __init__(self, key: object, first: int, again: int) -> None:
        super().__init__(key)
        self.key = key
        self.expected = f"each key once in its mapping; line {again} repeats line {first}"


class _EachKeyOnce(yaml.SafeLoader):
    """YAML's usual loader lets the second of two equal keys win, without a word."""

    def compose_mapping_node(self, anchor: dict[Any, yaml.Node]) -> yaml.MappingNode:
        # Looked at as it is written: what `<<` merges may be overridden.
        node = super().compose_mapping_node(anchor)
        lines: dict[Any, int] = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and key.tag != _MERGE:
                value, line = self.construct_object(key), key.start_mark.line + 1
                if value in lines:
                    raise _KeyTwice(value, lines[value], line)
                lines[value] = line
        return node


def parse_yaml(text: str, name: str) -> Any:
    """The values of a YAML text; `name` is the file's name in messages."""
    try:
        data = yaml.load(text, _EachKeyOnce)  # noqa: S506 - it is a safe loader
        if _weight(data, {}) > LARGEST_TEXT_BYTES:
            raise InvalidValue(name, text[:200], "aliases that do not multiply")
    except _KeyTwice as error:
        raise InvalidValue(name, error.key, error.expected) from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InvalidValue(name, text[:200], f"valid YAML ({reason[:300]})") from None
    return data


def _weight(node: Any, known: dict[int, int]) -> int:
    """How many values there are with every alias written out; aliases can make a bomb of a file."""
    if id(node) not in known:
        inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
        known[id(node)] = 1 + sum(_weight(one, known) for one in inner)
    return known[id(node)]
