"""A file that grows part by part and can be gone on with after an interruption."""

import json
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import read_text


class Joined:
    """Appends parts to one file; beside it stands how many are whole, and up to which byte.

    `origin` says where the parts come from: parts of another origin are not built upon.
    """

    def __init__(self, path: Path, origin: str) -> None:
        self._path = path
        self._origin = origin
        self._ledger = path.with_name(f"{path.name}.parts.json")
        self.parts, self.size = self._known()
        self.out: BinaryIO = path.open("r+b" if path.exists() else "wb")
        self.out.truncate(self.size)
        self.out.seek(self.size)

    def part_done(self) -> None:
        """What was written to `out` since the last time was one whole part."""
        self.out.flush()
        self.parts, self.size = self.parts + 1, self.out.tell()
        entry = {"origin": self._origin, "parts": self.parts, "size": self.size}
        self._ledger.write_text(json.dumps(entry), encoding="utf-8")

    def finish(self) -> Path:
        """All parts are there; the next one who joins this file starts anew."""
        self._ledger.unlink(missing_ok=True)
        return self._path

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.out.close()

    def _known(self) -> tuple[int, int]:
        try:
            entry = json.loads(read_text(self._ledger, self._ledger.name))
            parts, size = int(entry["parts"]), int(entry["size"])
            fits = entry["origin"] == self._origin and self._path.stat().st_size >= size
        except (OSError, InvalidValue, ValueError, KeyError, TypeError, RecursionError):
            return 0, 0
        return (parts, size) if fits else (0, 0)
