"""The component `process`: its health, as container engines ask for it, and what it takes."""

import os
import threading
import time
from collections.abc import Mapping
from pathlib import Path

from edgevox.ops.diagnostics.component import Component, Finding, Level, component
from edgevox.ops.health import Health

PAGE = os.sysconf("SC_PAGE_SIZE")


def process(health: Health, began_s: float, version: str, refusals: Mapping[str, int]) -> Component:
    """What is not alive is an error, what is not ready a warning. `began_s` is of `time.monotonic`.

    It says what /live and /ready say, so that both always agree. `refusals` counts by reason what
    was asked and not taken: whose fault that is nobody knows here, so it changes no level.
    """
    live, ready = health.live(), health.ready()
    found = [Finding(Level.ERROR, f"{name}: {said}") for name, said in live.checks.items() if said]
    found += [
        Finding(Level.WARN, f"{name}: {said}")
        for name, said in ready.checks.items()
        if said and name not in live.checks
    ]
    return component(
        "process",
        found,
        well="ready",
        version=version,
        uptime_s=round(time.monotonic() - began_s),
        memory_mib=resident_mib(),
        threads=threading.active_count(),
        **{f"refused_{reason}": count for reason, count in refusals.items()},
    )


def resident_mib() -> int | None:
    """The memory that this process has in RAM; None where the kernel does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return None
    return pages * PAGE // 2**20
