"""Disks: whether EdgeVox can write where it must, and whether there is room where it writes."""

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

MIB = 2**20
WARN_BYTES, WARN_PART = 1024 * MIB, 0.1
ERROR_BYTES, ERROR_PART = 100 * MIB, 0.02
"""Less is too little; of a small file system, such as a container's /tmp, less than this part."""


@dataclass(frozen=True, slots=True)
class DiskSpace:
    """A file system: `path` is a folder in it that exists."""

    path: Path
    device: int
    free: int
    size: int
    writable: bool

    @property
    def level(self) -> Level:
        """How well it is."""
        if self.free < min(ERROR_BYTES, ERROR_PART * self.size):
            return Level.ERROR
        return Level.WARN if self.free < min(WARN_BYTES, WARN_PART * self.size) else Level.OK


def room(folder: Path) -> DiskSpace:
    """The file system that a folder is, or would be, in."""
    try:
        seen, device = os.statvfs(folder), folder.stat().st_dev
    except (FileNotFoundError, NotADirectoryError):
        if folder == folder.parent:
            raise
        return room(folder.parent)
    writable = os.access(folder, os.W_OK) and not seen.f_flag & os.ST_RDONLY
    return DiskSpace(
        folder, device, seen.f_bavail * seen.f_frsize, seen.f_blocks * seen.f_frsize, writable
    )


def rooms(folders: Iterable[Path], look: Callable[[Path], DiskSpace] = room) -> Iterator[DiskSpace]:
    """Each file system of these folders that can be written to, once."""
    seen: set[int] = set()
    for one in map(look, folders):
        if one.writable and one.device not in seen:
            seen.add(one.device)
            yield one


class DiskComponent:
    """Says whether there is room in the file systems of these folders, which are asked anew.

    `needed` are folders that must be writable, or something that people rely on is lost.
    """

    name = ComponentName.DISK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self, folders: Callable[[], Iterable[Path]], needed: Callable[[], Iterable[Path]]
    ) -> None:
        self._folders = folders
        self._needed = needed

    def status(self) -> Status:
        """How it is now."""
        return disk_status(rooms(self._folders()), unwritable(self._needed()))


def unwritable(folders: Iterable[Path]) -> list[Path]:
    """Those in which nothing can be written, or which cannot be made."""
    return [folder for folder in folders if not room(folder).writable]


def disk_status(found: Iterable[DiskSpace], sealed: Iterable[Path] = ()) -> Status:
    """The component `disk`: file systems that are written to, and folders that cannot be."""
    here = list(found)
    findings = [
        Finding(one.level, f"{one.path}: {one.free // MIB} MiB left") for one in here if one.level
    ]
    findings += [Finding(Level.WARN, f"{folder}: not writable") for folder in sealed]
    values = {f"{one.path} free_mib": one.free // MIB for one in here}
    well = "enough room" if here else "nothing is written"
    return Status.judged("disk", findings, well=well, **values)
