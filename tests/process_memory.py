"""What Linux says that a process takes."""

from pathlib import Path
from typing import NamedTuple


class ProcessMemory(NamedTuple):
    """In MiB: all that is resident, and what of it is its own, no file's; and its threads."""

    rss_mb: float
    own_mb: float
    threads: int


def process_memory(pid: int | str = "self") -> ProcessMemory:
    """What it takes now. Raises `FileNotFoundError` if there is none."""
    lines = Path(f"/proc/{pid}/status").read_text("utf-8").splitlines()
    status = {name: rest.split() for name, _, rest in (one.partition(":") for one in lines)}
    rss, own = (int(status[name][0]) / 1024 for name in ("VmRSS", "RssAnon"))
    return ProcessMemory(rss, own, int(status["Threads"][0]))
