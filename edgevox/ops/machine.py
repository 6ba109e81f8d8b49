"""The machine and the process: hardware, memory, and the components `disk`, `process` and `clock`.

`return_memory` sets the C library's allocator so that free memory goes back to the machine. By
itself glibc gives each thread a heap of its own, and takes what is large from those heaps, too,
once something large was ever freed. Messages of a megabyte that go through ten threads leave holes
in ten heaps: a node that was flooded with them grew by 30 MB a minute and never shrank.

What a process takes are two numbers of ``/proc/self``, for which an agent needs no psutil.
"""

import ctypes
import os
import platform
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status
from edgevox.ops.health import Health

_M_MMAP_THRESHOLD, _M_ARENA_MAX = -3, -8
LARGE_BYTES = 256 * 1024
"""What is as large as this is mapped by itself, and unmapped when it is freed."""
HEAPS = 2


def return_memory() -> bool:
    """Set it for this process; call it before there are threads. False where that is not glibc.

    Who sets ``MALLOC_ARENA_MAX`` or ``MALLOC_MMAP_THRESHOLD_`` knows better.
    """
    wanted = (
        ("MALLOC_ARENA_MAX", _M_ARENA_MAX, HEAPS),
        ("MALLOC_MMAP_THRESHOLD_", _M_MMAP_THRESHOLD, LARGE_BYTES),
    )
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return False
    done = [mallopt(what, to) for name, what, to in wanted if name not in os.environ]
    return all(done)


MIB = 2**20
_GIB = 2**30
_NO_GPU: Mapping[str, Any] = {
    "cuda": False,
    "gpu_name": None,
    "vram_total_gb": None,
    "vram_used_mb": None,
}


def hardware_info() -> dict[str, Any]:
    """What the machine has; the values of a GPU are null where there is none."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        **_first_gpu(),
        "metal": platform.system() == "Darwin" and platform.machine() == "arm64",
        "ram_gb": round(memory / _GIB, 1),
    }


def _first_gpu() -> Mapping[str, Any]:
    import pynvml

    try:
        pynvml.nvmlInit()
    except pynvml.NVMLError:
        return _NO_GPU
    try:
        gpu = pynvml.nvmlDeviceGetHandleByIndex(0)
        memory = pynvml.nvmlDeviceGetMemoryInfo(gpu)
        return {
            "cuda": True,
            "gpu_name": str(pynvml.nvmlDeviceGetName(gpu)),
            "vram_total_gb": round(int(memory.total) / _GIB, 1),
            "vram_used_mb": round(int(memory.used) / MIB),
        }
    except pynvml.NVMLError:
        return _NO_GPU
    finally:
        pynvml.nvmlShutdown()


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
    return pages * PAGE // MIB


_UNSYNCHRONISED = 0x40  # STA_UNSYNC of adjtimex(2)
_STATUS = 10  # after modes (with padding), offset, freq, maxerror and esterror
NEVER_SET_BEFORE_S = 1_704_067_200.0
"""2024: a clock before that was never set."""
NEVER_SET, NOT_SYNCHRONISED = "the clock was never set", "the clock is not synchronised"


def synchronised() -> bool | None:
    """Whether the kernel's clock is synchronised; None where that may not be asked.

    The kernel is told by whoever sets the clock: systemd-timesyncd, ntpd, chrony with ``rtcsync``.
    """
    asked = (ctypes.c_int * 64)()  # struct timex: `modes` first, of zero, so that nothing is set
    try:
        if ctypes.CDLL(None, use_errno=True).adjtimex(asked) < 0:
            return None
    except (OSError, AttributeError):  # not Linux
        return None
    return not asked[_STATUS] & _UNSYNCHRONISED


class ClockComponent:
    """A clock that is not synchronised is a warning, one that was never set an error.

    Other machines compare a robot's stamps with their own clocks, and a recording is found by its
    time.
    """

    name = ComponentName.CLOCK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self,
        is_synchronised: Callable[[], bool | None] = synchronised,
        now_s: Callable[[], float] = time.time,
    ) -> None:
        self._synchronised, self._now_s = is_synchronised, now_s

    def status(self) -> Status:
        """How it is now."""
        known = self._synchronised()
        found = []
        if self._now_s() < NEVER_SET_BEFORE_S:
            found.append(Finding(Level.ERROR, NEVER_SET))
        if known is False:
            found.append(Finding(Level.WARN, NOT_SYNCHRONISED))
        well = "synchronised" if known else "whether it is synchronised cannot be seen here"
        return Status.judged(self.name, found, well=well, synchronised=known)
