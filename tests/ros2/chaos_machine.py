"""How busy the machine is before the chaos, which asks for one that is idle."""

import os
import time
from pathlib import Path

LOOKED_S = 2.0
IDLE_CORES = 0.3
"""Less than this is an idle machine: a desktop, an agent at rest."""


def _busy_s() -> float:
    """Seconds that all cores together were busy since the start of the machine."""
    user, nice, system, _, _, irq, soft_irq, *_ = map(
        int, Path("/proc/stat").read_text(encoding="utf-8").split("\n", 1)[0].split()[1:]
    )
    return (user + nice + system + irq + soft_irq) / os.sysconf("SC_CLK_TCK")


def busy_cores() -> float:
    """How many cores were busy in the last seconds."""
    began_s, before_s = time.monotonic(), _busy_s()
    time.sleep(LOOKED_S)
    return (_busy_s() - before_s) / (time.monotonic() - began_s)


def told(cores: float) -> str:
    """What was measured, and what is asked for where that is not it."""
    line = f"{cores:.2f} of {os.cpu_count()} cores were busy with something else before it began"
    if cores < IDLE_CORES:
        return line
    return f"{line}; it asks for an idle machine: what takes time may have failed for that alone"
