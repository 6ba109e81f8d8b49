"""What this process may use of the machine: processors and memory, as Linux's control groups say.

A container that is limited to two of sixteen cores still sees sixteen. Whoever starts a thread for
each of them is stopped for most of every tenth of a second, together with the robot. Read here,
since psutil tells of the machine and knows no control groups.
"""

import math
import os
from collections.abc import Iterator
from pathlib import Path

_PROC = Path("/proc/self/cgroup")
_ROOT = Path("/sys/fs/cgroup")
_UNLIMITED_BYTES = 1 << 60
"""How version 1 writes that there is no limit: more memory than any machine has."""


def usable_cpus(affinity: int | None = None, quota: float | None = None) -> int:
    """How many threads can compute at once: the cores allowed, and no more than the quota pays.

    A part of a core is left to threads that do not compute without end; there is always one.
    """
    cores = affinity or len(os.sched_getaffinity(0))
    paid = cpu_quota() if quota is None else quota
    return max(1, min(cores, math.floor(paid) if math.isfinite(paid) else cores))


def cpu_quota(proc: Path = _PROC, root: Path = _ROOT) -> float:
    """How many processors' time this process may take; infinite where nothing limits it."""
    return min((_quota(folder) for folder in _folders("cpu", proc, root)), default=math.inf)


def memory_left(proc: Path = _PROC, root: Path = _ROOT) -> int | None:
    """Bytes that may still be taken before the kernel ends somebody; None where nothing limits."""
    left = [_left(folder) for folder in _folders("memory", proc, root)]
    return min((bytes_ for bytes_ in left if bytes_ is not None), default=None)


def _folders(controller: str, proc: Path, root: Path) -> Iterator[Path]:
    """The folders of this process's group and of all around it, each of which may limit it.

    In a container the path that /proc tells may be the host's; what is mounted is its own group.
    """
    for base, path in _groups(controller, proc, root):
        inside = base / path
        while inside != base:
            yield inside
            inside = inside.parent
        yield base


def _groups(controller: str, proc: Path, root: Path) -> Iterator[tuple[Path, str]]:
    """Where a controller is mounted, with the process's path below it, in version 1 and 2."""
    for line in _text(proc).splitlines():
        _, controllers, path = line.split(":", 2)
        if not controllers:
            yield root, path.strip("/")
        elif controller in controllers.split(","):
            yield root / controllers, path.strip("/")
            yield root / controller, path.strip("/")


def _quota(folder: Path) -> float:
    match _text(folder / "cpu.max").split():
        case [quota, period] if quota != "max":
            return int(quota) / int(period)
    quota, period = (_text(folder / f"cpu.cfs_{name}_us").strip() for name in ("quota", "period"))
    return int(quota) / int(period) if quota and period and int(quota) > 0 else math.inf


def _left(folder: Path) -> int | None:
    """The limit less what is taken; files that were read can be forgotten and count as free."""
    for limit, taken, forgettable in (
        ("memory.max", "memory.current", "inactive_file"),
        ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    ):
        most, now = _text(folder / limit).strip(), _text(folder / taken).strip()
        if most.isdigit() and now.isdigit() and int(most) < _UNLIMITED_BYTES:
            lines = (line.split() for line in _text(folder / "memory.stat").splitlines())
            free = sum(int(value) for name, value in lines if name == forgettable)
            return max(0, int(most) - int(now) + free)
    return None


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="ascii", errors="replace")
    except OSError:
        return ""
