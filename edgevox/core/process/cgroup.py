"""Limits of this process by Linux's control groups: processors and memory.

A container that is limited to two of sixteen cores still sees sixteen. A program that starts a
thread for each of them is stopped for most of every tenth of a second, together with the robot.
This module reads the limits itself, because psutil knows no control groups.
"""

import math
import os
from collections.abc import Iterator
from pathlib import Path

_PROC = Path("/proc/self/cgroup")
_ROOT = Path("/sys/fs/cgroup")
_UNLIMITED_BYTES = 1 << 60
"""Limits from here on mean no limit: version 1 writes a number beyond any machine's memory."""


def usable_cpus(affinity: int | None = None, quota: float | None = None) -> int:
    """Number of threads that can compute at once, by the allowed cores and the quota, at least 1.

    A fraction of a core is left to threads that do not compute all the time.
    """
    cores = affinity or len(os.sched_getaffinity(0))
    paid = cpu_quota() if quota is None else quota
    return max(1, min(cores, math.floor(paid) if math.isfinite(paid) else cores))


def cpu_quota(proc: Path = _PROC, root: Path = _ROOT) -> float:
    """Number of processors whose time this process may take; infinite without a limit."""
    return min((_quota(folder) for folder in _folders("cpu", proc, root)), default=math.inf)


def memory_left(proc: Path = _PROC, root: Path = _ROOT) -> int | None:
    """Bytes left before the kernel kills a process of the group; None without a limit."""
    left = [_left(folder) for folder in _folders("memory", proc, root)]
    return min((bytes_ for bytes_ in left if bytes_ is not None), default=None)


def _folders(controller: str, proc: Path, root: Path) -> Iterator[Path]:
    """The folders of this process's group and of its parents, each of which may limit it.

    In a container, /proc may show the host's path; the mounted folder is the container's group.
    """
    for base, path in _groups(controller, proc, root):
        inside = base / path
        while inside != base:
            yield inside
            inside = inside.parent
        yield base


def _groups(controller: str, proc: Path, root: Path) -> Iterator[tuple[Path, str]]:
    """Folders where a controller is mounted, with the process's path below, in version 1 and 2."""
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
    """The limit less the memory in use; cached files can be dropped and count as free."""
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
