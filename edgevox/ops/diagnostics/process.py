"""The component `process`: its health, as container engines ask for it, and what it takes.

That is two numbers of ``/proc/self``, for which an agent needs no psutil.
"""

import os
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status
from edgevox.ops.health import Health

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
