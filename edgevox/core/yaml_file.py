"""Reads YAML that people write and others send: bounded in size, also with aliases."""

from typing import Any

import yaml

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import LARGEST_TEXT_BYTES


def parse_yaml(text: str, name: str) -> Any:
    """The values of a YAML text; `name` is the file's name in messages."""
    try:
        data = yaml.safe_load(text)
        if _weight(data, {}) > LARGEST_TEXT_BYTES:
            raise InvalidValue(name, text[:200], "aliases that do not multiply")
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
