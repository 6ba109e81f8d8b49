"""Files that are there as a whole, or as they were."""

from collections.abc import Callable
from pathlib import Path
from typing import IO


def write_whole(file: Path, write: Callable[[IO[bytes]], None]) -> None:
    """Let `write` write all of it, then put it in the file's place."""
    part = file.with_suffix(".new")
    with part.open("wb") as out:
        write(out)
    part.replace(file)
