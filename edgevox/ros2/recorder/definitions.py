"""The text of a message type's definition, with all types that it refers to.

It is read from the installed interfaces, comments and all. `rosbags` would write its own text for
the types that it knows, and bring four packages into the image.
"""

import importlib.util
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

from edgevox.core.errors import EdgeVoxError

_SEPARATOR = "=" * 80
_FIELD = re.compile(r"^\s*(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*")
_PRIMITIVES = frozenset(
    {
        *("bool", "byte", "char", "float32", "float64", "string", "wstring"),
        *("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
    }
)
_HASH = "type_hashes"


class DefinitionMissing(EdgeVoxError):
    """The `.msg` file of a type is nowhere to be found."""


def definition(kind: str) -> str:
    """All of `package/msg/Type` in the format that MCAP calls ros2msg.

    Raises `DefinitionMissing`.
    """
    known = {kind: _read(kind)}
    waiting = [kind]
    while waiting:
        one = waiting.pop()
        for inner in _refers_to(known[one], one.partition("/")[0]):
            if inner not in known:
                known[inner] = _read(inner)
                waiting.append(inner)
    parts = [known.pop(kind).rstrip("\n")]
    for name, text in known.items():
        parts.append(f"{_SEPARATOR}\nMSG: {name.replace('/msg/', '/')}\n{text.rstrip()}")
    return "\n".join(parts) + "\n"


def type_hash(kind: str) -> str:
    """The REP 2016 hash of a type, as a publisher offers it; empty where it was not installed."""
    file = _file(kind, ".json")
    if file is None:
        return ""
    hashes = json.loads(file.read_text(encoding="utf-8")).get(_HASH, ())
    return next((str(one["hash_string"]) for one in hashes if one["type_name"] == kind), "")


def _refers_to(text: str, package: str) -> Iterator[str]:
    for line in text.splitlines():
        found = _FIELD.match(line.partition("#")[0])
        if found is None or found["type"] in _PRIMITIVES:
            continue
        names = found["type"].split("/")
        yield f"{names[0] if len(names) > 1 else package}/msg/{names[-1]}"


def _read(kind: str) -> str:
    file = _file(kind, ".msg")
    if file is None:
        raise DefinitionMissing(f"{kind}: got no .msg file, expected one in an ament prefix")
    return file.read_text(encoding="utf-8")


def _file(kind: str, suffix: str) -> Path | None:
    package = kind.partition("/")[0]
    candidates = (prefix / "share" / f"{kind}{suffix}" for prefix in _prefixes(package))
    return next((file for file in candidates if file.is_file()), None)


def _prefixes(package: str) -> Iterator[Path]:
    """Return the module's install prefix, then those in the environment."""
    spec = importlib.util.find_spec(package)
    if spec and spec.origin:
        yield from list(Path(spec.origin).parents)[3:6]  # PREFIX[/local]/lib/pythonX/site-packages
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            yield Path(prefix)
