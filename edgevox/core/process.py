"""The process itself: its limits by Linux's control groups, and its output stream.

A container that is limited to two of sixteen cores still sees sixteen. A program that starts a
thread for each of them is stopped for most of every tenth of a second, together with the robot.
This module reads the limits itself, because psutil knows no control groups.

A program works on if its lines cannot be written, so nothing here raises or waits for long.
Imports nothing that is slow to import.
"""

import io
import math
import os
import select
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

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


PATIENCE_S = 0.1
"""Seconds that a line waits for a slow reader; after that, lines are lost until it reads on."""
ASLEEP = "its reader does not read"

Tell = Callable[[OSError], None]


class OutputReader:
    """The reader at the other end of a file descriptor."""

    def __init__(self, number: int) -> None:
        self._poll = select.poll()
        self._poll.register(number, select.POLLOUT)
        self._asleep = False

    def awake(self) -> bool:
        """True if there is room for `select.PIPE_BUF` bytes, now or within `PATIENCE_S`."""
        wait_s = 0.0 if self._asleep else PATIENCE_S
        events = self._poll.poll(wait_s * 1000)
        self._asleep = not events
        return bool(events)


class OutputStream(io.RawIOBase):
    """Writes to a file descriptor, and drops data that cannot be written.

    `tell` gets the error once, and again only after a successful write. A stream with `waits` waits
    for a slow reader; that suits programs whose purpose is their output. Closing the stream leaves
    the descriptor open.
    """

    def __init__(self, number: int, tell: Tell, *, waits: bool) -> None:
        super().__init__()
        self._number = number
        self._tell = tell
        self._told = False
        mode = os.fstat(number).st_mode
        flows = stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)
        self._most = select.PIPE_BUF if flows else io.DEFAULT_BUFFER_SIZE
        self._reader = None if waits or not flows else OutputReader(number)

    def fileno(self) -> int:
        return self._number

    def isatty(self) -> bool:
        return os.isatty(self._number)

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        """Write data and return the number of bytes taken; all bytes if writing fails."""
        piece = bytes(memoryview(data)[: self._most])
        try:
            if self._reader and not self._reader.awake():
                raise OSError(ASLEEP)
            written = os.write(self._number, piece)
        except OSError as error:
            if not self._told:
                self._told = True
                self._tell(error)
            return len(data)
        self._told = False
        return written
