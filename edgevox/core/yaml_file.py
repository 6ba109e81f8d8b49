"""Reads YAML files that people write and others send: bounded in size, also with aliases."""

from pathlib import Path
from typing import Any

import yaml

from edgevox.core.errors import InvalidValue

LARGEST_FILE_BYTES = 1_000_000


def read_text(file: Path, field: str) -> str:
    """The file's text. Raises `InvalidValue`, naming `field`, if it is no readable small text."""
    try:
        with file.open("rb") as stream:
            data = stream.read(LARGEST_FILE_BYTES + 1)
    except OSError as error:
        raise InvalidValue(
            field, str(file), f"a file that can be read ({error.strerror})"
        ) from None
    if len(data) > LARGEST_FILE_BYTES:
        raise InvalidValue(field, str(file), f"at most {LARGEST_FILE_BYTES} bytes")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        raise InvalidValue(field, str(file), "a text in UTF-8") from None


def parse_yaml(text: str, name: str) -> Any:
    """The values of a YAML text; `name` is the file's name in messages."""
    try:
        data = yaml.safe_load(text)
        if _weight(data, {}) > LARGEST_FILE_BYTES:
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
