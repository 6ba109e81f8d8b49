"""The recordings of a console on its disk: what there is to take, and how much room is left."""

import shutil
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from edgevox.core.errors import EdgeVoxError

MB = 1_000_000
SPARE_MB = 500
"""What is left of the disk to others."""


class KeptRecordings:
    """A folder with one of its own for each recording. Any thread; nothing goes by itself.

    most_bytes: how many all recordings have together at most.
    """

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self.folder = folder
        self._most_bytes = most_bytes
        self._lock = threading.Lock()
        self._earlier: frozenset[Path] | None = None
        """Those that were there when the one began that is being written."""

    def make_folder(self) -> int:
        """Have the folder; the bytes that a new recording has room for. Raises `EdgeVoxError`."""
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            return self._room()
        except OSError as error:
            raise EdgeVoxError(f"record: {self.folder}: {error.strerror or error}") from None

    def begin(self) -> None:
        """Another is written from now on: it is not offered before `end`."""
        with self._lock:
            self._earlier = frozenset(self.folder.iterdir())

    def end(self) -> None:
        """What was written is whole."""
        with self._lock:
            self._earlier = None

    def room(self) -> int:
        """How many more bytes there may be; below 0 where there are too many, 0 if nobody knows."""
        try:
            return self._room()
        except OSError:
            return 0

    def begun_bytes(self) -> int:
        """How large the one is that is being written."""
        over = set(self.files())
        return sum(_size(one) for one in self._found() if one not in over)

    def files(self) -> Sequence[Path]:
        """Those that are over, the newest first."""
        with self._lock:
            earlier = self._earlier
        found = (one for one in self._found() if earlier is None or one.parent in earlier)
        return sorted(found, key=lambda file: file.name, reverse=True)

    def told(self) -> list[Mapping[str, Any]]:
        """The same as pages are told it: name, bytes, and when it was begun if that is known."""
        found: list[Mapping[str, Any]] = []
        for one in self.files():
            with suppress(FileNotFoundError):  # it was deleted just now
                found.append({"name": one.name, "bytes": one.stat().st_size, "begun": _begun(one)})
        return found

    def delete(self, name: str) -> None:
        """Remove the recording of this file. Raises `EdgeVoxError`."""
        for file in self.files():
            if file.name == name:
                file.unlink(missing_ok=True)
                if not any(file.parent.glob("*.mcap")):
                    shutil.rmtree(file.parent, ignore_errors=True)
                return
        raise EdgeVoxError(f"record: {name!r} is no recording")

    def _found(self) -> Iterator[Path]:
        return (file for file in self.folder.glob("edgevox-*/*.mcap") if file.is_file())

    def _room(self) -> int:
        near = next(one for one in (self.folder, *self.folder.parents) if one.exists())
        free = shutil.disk_usage(near).free - SPARE_MB * MB
        return min(free, self._most_bytes - sum(_size(one) for one in self._found()))


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except FileNotFoundError:
        return 0


def _begun(file: Path) -> float | None:
    """Seconds since 1970, by the name of its folder, which is in UTC."""
    try:
        return datetime.strptime(f"{file.parent.name}Z", "edgevox-%Y%m%d-%H%M%S%z").timestamp()
    except ValueError:
        return None
