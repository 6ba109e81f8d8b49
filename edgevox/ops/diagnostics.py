"""Components that belong to no other package: the disks and the process.

`DiskComponent` says whether there is room where EdgeVox writes. `ProcessComponent` has the health,
as container engines ask for it, and what the process takes: two numbers of ``/proc/self``, for
which an agent needs no psutil.
"""

import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status
from edgevox.ops.health import Health

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
    """Says whether there is room in the file systems of these folders, which are asked anew."""

    name = ComponentName.DISK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, folders: Callable[[], Iterable[Path]]) -> None:
        self._folders = folders

    def status(self) -> Status:
        """How it is now."""
        return disk_status(rooms(self._folders()))


def disk_status(found: Iterable[DiskSpace]) -> Status:
    """The component `disk`."""
    here = list(found)
    findings = [
        Finding(one.level, f"{one.path}: {one.free // MIB} MiB left") for one in here if one.level
    ]
    values = {f"{one.path} free_mib": one.free // MIB for one in here}
    well = "enough room" if here else "nothing is written"
    return Status.judged("disk", findings, well=well, **values)


PAGE = os.sysconf("SC_PAGE_SIZE")
_TASKS = Path("/proc/self/task")


class ProcessComponent:
    """What is not alive is an error, what is not ready a warning.

    It says what /live and /ready say, so that both always agree. `refusals` counts by reason what
    was asked and not taken: whose fault that is nobody knows here, so it changes no level.
    """

    name = ComponentName.PROCESS
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self, health: Health, version: str, refusals: Callable[[], Mapping[str, int]]
    ) -> None:
        self._health, self._version, self._refusals = health, version, refusals
        self._began_s = time.monotonic()

    def status(self) -> Status:
        """How it is now."""
        live, ready = self._health.live(), self._health.ready()
        found = [
            Finding(Level.ERROR if name in live.checks else Level.WARN, f"{name}: {said}")
            for name, said in ready.checks.items()
            if said
        ]
        return Status.judged(
            self.name,
            found,
            well="ready",
            version=self._version,
            uptime_s=round(time.monotonic() - self._began_s),
            memory_mib=resident_mib(),
            threads=count_threads(),
            **{f"refused_{reason}": count for reason, count in self._refusals().items()},
        )


def count_threads() -> int:
    """All threads, native ones too; where the system does not say, those of Python."""
    return len(os.listdir(_TASKS)) if _TASKS.is_dir() else threading.active_count()


def resident_mib() -> int | None:
    """The memory that this process has in RAM; None where the kernel does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return None
    return pages * PAGE // 2**20
