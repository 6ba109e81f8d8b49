"""`plugins.sha256`: the only files that a folder of plug-ins may hold."""

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import open_file, read_text

HASHES = "plugins.sha256"
LARGEST_BYTES = 200_000_000
_LINE = re.compile(r"([0-9a-f]{64}) [ *](?:\./)?(.+)")


def check_hashes(folder: Path) -> None:
    """Raises `InvalidValue` unless such a file, if there is one, tells of all and is right.

    A file that it does not name is refused as well: Python would run one that was put there.
    """
    listing = folder / HASHES
    if not os.path.lexists(listing):  # one that leads nowhere is there, and cannot be read
        return
    wanted = _wanted(listing)
    found = set(_files(folder))
    for name in sorted(wanted.keys() | found):
        field = f"plugins: {name}"
        if name not in found:
            raise InvalidValue(field, str(folder), f"the file that {HASHES} names")
        if name not in wanted:
            raise InvalidValue(field, str(folder), f"no file that {HASHES} does not name")
        if (digest := _sha256(folder / name, field)) != wanted[name]:
            raise InvalidValue(field, digest, f"{wanted[name]}, as {HASHES} says")


def _wanted(listing: Path) -> dict[str, str]:
    wanted = {}
    for number, line in enumerate(read_text(listing, HASHES).splitlines(), 1):
        if not line.strip():
            continue
        if (parts := _LINE.fullmatch(line)) is None:
            raise InvalidValue(f"{HASHES}: line {number}", line, "a SHA-256, two spaces, a file")
        wanted[parts[2]] = parts[1]
    return wanted


def _files(folder: Path) -> Iterator[str]:
    """What can be loaded; not `..data` and the like, which Kubernetes keeps beside its mounts."""
    seen: set[tuple[int, int]] = set()
    for place, folders, names in os.walk(folder, followlinks=True):
        here = Path(place)
        identity = here.stat().st_dev, here.stat().st_ino
        if identity in seen:  # followed for ever, or twice as often at each level
            field = f"plugins: {here.relative_to(folder).as_posix()}"
            raise InvalidValue(field, str(folder), "each folder once, by one name")
        seen.add(identity)
        folders[:] = [one for one in folders if here != folder or not one.startswith(".")]
        for name in names:
            relative = (here / name).relative_to(folder)
            if not (here == folder and (name == HASHES or name.startswith("."))):
                yield relative.as_posix()


def _sha256(file: Path, field: str) -> str:
    with open_file(file, field, LARGEST_BYTES) as stream:
        return hashlib.sha256(stream.read(LARGEST_BYTES)).hexdigest()
