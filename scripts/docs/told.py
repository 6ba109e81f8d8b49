"""What `told.toml` says, held against the names that the code has."""

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

TOLD: dict[str, Any] = tomllib.loads(Path(__file__).with_name("told.toml").read_text("utf-8"))


def told(names: Iterable[object], *path: str) -> dict[str, Any]:
    """What a table of `told.toml` says of these names. Raises `ValueError` where they differ."""
    entries = TOLD
    for key in path:
        entries = entries[key]
    if differing := set(map(str, names)) ^ entries.keys():
        raise ValueError(
            f"scripts/docs/told.toml [{'.'.join(path)}]: {', '.join(sorted(differing))}: "
            "expected exactly the names that the code has"
        )
    return entries
