"""Looks packages up in OSV's entries on the disk, as OSV's schema says, for `scan.py`.

A database is a file of OSV such as `all.zip` of an ecosystem, a single entry, or a folder of both.
Nothing is unpacked on the disk. Only PyPI's, npm's, Debian's and Ubuntu's versions are compared.
"""

import json
import re
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import Any

from packaging.version import InvalidVersion, Version

IDENTIFIER = re.compile(r"[A-Za-z0-9][\w.:-]{0,99}", re.ASCII)
"""What names an entry, such as CVE-2024-1."""
MALFORMED = (ValueError, LookupError, TypeError, AttributeError, RecursionError)
"""What is raised by something in JSON that is not of the form that it should be of."""
MOST_ENTRY_BYTES = 16 << 20
MOST_BYTES = 64 << 30
"""Of all entries together, unpacked: Ubuntu's name every version of every kernel."""
_UNREADABLE = (OSError, zipfile.BadZipFile, zlib.error, RuntimeError, EOFError)
"""What a damaged, encrypted or strangely compressed archive raises."""


class CouldNotLook(Exception):
    """Nothing is known; the message says why."""


@dataclass(frozen=True, order=True)
class Package:
    """What is looked up."""

    ecosystem: str
    name: str
    version: str

    def __str__(self) -> str:
        return f"{self.ecosystem} {self.name} {self.version}"

    def query(self) -> dict[str, Any]:
        """As OSV's service wants it."""
        return {
            "package": {"ecosystem": self.ecosystem, "name": self.name},
            "version": self.version,
        }


@dataclass
class Looked:
    """What a database knows."""

    found: dict[Package, set[str]] = field(default_factory=dict)
    """The ids of entries, for packages that have any."""
    unknown: list[str] = field(default_factory=list)
    """What it cannot tell."""
    newest: str = ""
    """When the newest of its entries was changed: how old the database is."""


def look_up(packages: Sequence[Package], path: Path) -> Looked:
    """All that a database knows of these. Raises `CouldNotLook` if it cannot be read to its end."""
    looked, ecosystems = Looked(), set[str]()
    wanted: dict[tuple[str, str], list[Package]] = {}
    for package in packages:
        for ecosystem in {package.ecosystem, _system(package.ecosystem)}:
            wanted.setdefault((ecosystem, package.name), []).append(package)
    for place, text in _entries(path):
        try:
            entry = json.loads(text)
            if not IDENTIFIER.fullmatch(entry["id"]):
                raise ValueError("an id that names no vulnerability")
            looked.newest = max(looked.newest, str(entry["modified"]))
            for affected in entry.get("affected") or ():
                about = affected.get("package") or {"ecosystem": "", "name": ""}
                ecosystem, name = _release(str(about["ecosystem"])), str(about["name"])
                ecosystems.add(ecosystem)
                key = (ecosystem, python_name(name) if ecosystem == "PyPI" else name)
                if not entry.get("withdrawn"):
                    _judge(entry["id"], affected, wanted.get(key, ()), looked)
        except MALFORMED as error:
            raise CouldNotLook(f"{place}: not an entry of OSV: {error}") from error
    for ecosystem in sorted({one.ecosystem for one in packages}):
        if not {ecosystem, _system(ecosystem)} & ecosystems:
            looked.unknown.append(f"{path} has no entries of {ecosystem}")
    return looked


def python_name(name: str) -> str:
    """The one spelling of a Python package's name that OSV knows."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _release(ecosystem: str) -> str:
    """An ecosystem, with Ubuntu Pro's for the release that it is of.

    What only Pro has mended is under Pro alone, and is not mended where nobody has Pro.
    """
    return ecosystem.replace("Ubuntu:Pro:", "Ubuntu:", 1)


def _system(ecosystem: str) -> str:
    """An ecosystem without its release: an entry for Debian is for each of its releases."""
    return ecosystem.partition(":")[0]


def _judge(
    number: str, affected: Mapping[str, Any], packages: Iterable[Package], looked: Looked
) -> None:
    for package in packages:
        try:
            if _is_affected(package, affected):
                looked.found.setdefault(package, set()).add(number)
        except _Incomparable as error:
            looked.unknown.append(f"{package}, {number}: {error}")


class _Incomparable(Exception):
    """Versions of which nobody can tell which is newer."""


def _is_affected(package: Package, affected: Mapping[str, Any]) -> bool:
    """As OSV's schema evaluates it: the list of versions, or one of the ranges."""
    if package.version in (versions := affected.get("versions") or ()):
        return True
    key = _COMPARED[_system(package.ecosystem)]
    ranges = [one for one in affected.get("ranges") or () if one["type"] in ("ECOSYSTEM", "SEMVER")]
    if not versions and not ranges:
        raise _Incomparable("its entry tells no versions")
    version = _key(key, package.version)
    for one in versions:  # spelt otherwise
        with suppress(_Incomparable):
            if _key(key, one) == version:
                return True
    return any(_in_range(version, one["events"], key) for one in ranges)


def _in_range(version: Any, events: Iterable[Mapping[str, str]], key: Callable[[str], Any]) -> bool:
    """Whether the last change up to this version made it vulnerable."""
    vulnerable, changes, limits = False, list[tuple[Any, int]](), list[str]()
    for event in events:
        ((kind, bound),) = event.items()
        if kind == "limit":
            limits.append(bound)
        elif (kind, bound) == ("introduced", "0"):  # in front of all versions
            vulnerable = True
        else:
            changes.append((_key(key, bound), _CHANGES.index(kind)))
    for at, change in sorted(changes):
        if change == _LAST_AFFECTED:
            vulnerable = vulnerable and not version > at
        elif version >= at:
            vulnerable = change == _INTRODUCED
    return vulnerable and (
        not limits or any(one == "*" or version < _key(key, one) for one in limits)
    )


_CHANGES = ("fixed", "introduced", "last_affected")
"""In the order in which those of one version count."""
_INTRODUCED, _LAST_AFFECTED = 1, 2


def _key(key: Callable[[str], Any], version: str) -> Any:
    try:
        return key(version)
    except (InvalidVersion, ValueError):
        raise _Incomparable(f"no version of its ecosystem: {version!r}") from None


_SEMVER = re.compile(r"v?(\d+)\.(\d+)\.(\d+)(?:-([0-9A-Za-z.-]+))?(?:\+[0-9A-Za-z.-]+)?", re.ASCII)


def _semver(version: str) -> tuple[Any, ...]:
    """Sorts as semver.org says: a pre-release is older than its release, numbers than words."""
    if not (found := _SEMVER.fullmatch(version)):
        raise ValueError(version)
    parts = (found[4] or "").split(".") if found[4] else []
    before = tuple((0, int(one), "") if one.isdigit() else (1, 0, one) for one in parts)
    return (int(found[1]), int(found[2]), int(found[3]), not before, before)


_DEBIAN = re.compile(r"(?:(\d+):)?([\w.+~:-]+)", re.ASCII)


@dataclass(frozen=True)
class _Debian:
    """A version as deb-version(7) orders it."""

    epoch: int
    upstream: str
    revision: str

    def __lt__(self, other: "_Debian") -> bool:
        return self._compare(other) < 0

    def __gt__(self, other: "_Debian") -> bool:
        return self._compare(other) > 0

    def __ge__(self, other: "_Debian") -> bool:
        return self._compare(other) >= 0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Debian) and self._compare(other) == 0

    def __hash__(self) -> int:
        return hash(self.epoch)

    def _compare(self, other: "_Debian") -> int:
        return (
            self.epoch - other.epoch
            or _compare_parts(self.upstream, other.upstream)
            or _compare_parts(self.revision, other.revision)
        )


def _debian(version: str) -> _Debian:
    if not (found := _DEBIAN.fullmatch(version)):
        raise ValueError(version)
    upstream, dash, revision = found[2].rpartition("-")
    return _Debian(int(found[1] or 0), *((upstream, revision) if dash else (revision, "")))


def _compare_parts(one: str, other: str) -> int:
    """Words and numbers in turn; `~` is before the end, then come letters, then other signs."""
    rows = (re.findall(r"(\D*)(\d*)", text) for text in (one, other))
    for (word, number), (other_word, other_number) in zip_longest(*rows, fillvalue=("", "")):
        ranks = ([*map(_rank, text), 0] for text in (word, other_word))
        for rank, other_rank in zip_longest(*ranks, fillvalue=0):
            if rank != other_rank:
                return rank - other_rank
        if difference := int(number or 0) - int(other_number or 0):
            return difference
    return 0


def _rank(letter: str) -> int:
    if letter == "~":
        return -1
    return ord(letter) if letter.isalpha() else ord(letter) + 256


_COMPARED: Mapping[str, Callable[[str], Any]] = {
    "PyPI": Version,
    "npm": _semver,
    "Debian": _debian,
    "Ubuntu": _debian,
}


def _entries(path: Path) -> Iterator[tuple[str, bytes]]:
    """Each entry with where it is."""
    files = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
    left, any_entry = MOST_BYTES, False
    try:
        for place, text in (row for file in files for row in _in_file(file)):
            left -= len(text)
            if len(text) > MOST_ENTRY_BYTES or left < 0:
                most = f"{MOST_ENTRY_BYTES >> 20} MiB in one, or {MOST_BYTES >> 30} GiB in all"
                raise CouldNotLook(f"{place}: more than {most}")
            any_entry = True
            yield place, text
    except _UNREADABLE as error:
        raise CouldNotLook(f"{path}: {error}") from error
    if not any_entry:
        raise CouldNotLook(f"{path}: no entries of OSV: no .json, and none in a .zip")


def _in_file(file: Path) -> Iterator[tuple[str, bytes]]:
    if file.suffix == ".zip":
        with zipfile.ZipFile(file) as archive:
            for one in archive.infolist():
                if one.filename.endswith(".json"):
                    with archive.open(one) as stream:
                        yield f"{file}: {one.filename}", stream.read(MOST_ENTRY_BYTES + 1)
    elif file.suffix == ".json":
        with file.open("rb") as stream:
            yield str(file), stream.read(MOST_ENTRY_BYTES + 1)
