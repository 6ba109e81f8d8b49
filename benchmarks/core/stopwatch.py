"""Time that passes, time of the processor and memory: of this process, its threads, and others."""

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self


@dataclass(frozen=True, slots=True)
class Spent:
    """Seconds that passed, that all threads worked, and that the watched thread worked."""

    passed_s: float
    process_s: float
    thread_s: float


class Stopwatch:
    """Measures a `with` block.

    Where several threads or programs share a machine, only the time of the processor says what
    something costs. `thread` is the name of a thread that runs all the while, such as a world's.
    """

    def __init__(self, thread: str | None = None) -> None:
        self._thread = thread
        self.spent = Spent(0.0, 0.0, 0.0)

    def __enter__(self) -> Self:
        self._clock = _clock_of(self._thread)
        self._began = self._now()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        began, now = self._began, self._now()
        self.spent = Spent(*(after - before for before, after in zip(began, now, strict=True)))

    def _now(self) -> tuple[float, float, float]:
        thread_s = time.clock_gettime(self._clock) if self._clock is not None else 0.0
        return time.perf_counter(), time.process_time(), thread_s


@contextmanager
def repeatedly(do: Callable[[], object], every_s: float, thread: str) -> Iterator[None]:
    """Do it on a thread of this name every so many seconds, as long as the block lasts."""
    over = threading.Event()

    def work() -> None:
        while not over.wait(every_s):
            do()

    worker = threading.Thread(target=work, name=thread)
    worker.start()
    try:
        yield
    finally:
        over.set()
        worker.join()


def _clock_of(name: str | None) -> int | None:
    for thread in threading.enumerate():
        if name is not None and thread.name == name and thread.ident is not None:
            return time.pthread_getcpuclockid(thread.ident)
    return None


def cpu_s(process: int) -> float:
    """Seconds that a process has worked so far, all threads together, to a hundredth."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def percent_of(process: int, seconds: float) -> float:
    """How much of one core a process takes in the next seconds."""
    before, began = cpu_s(process), time.monotonic()
    time.sleep(seconds)
    return 100 * (cpu_s(process) - before) / (time.monotonic() - began)


def resident_mb(process: int) -> float:
    """Memory that a process has, in MB."""
    lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    return next(int(x.split()[1]) for x in lines if x.startswith("VmRSS")) * 1024 / 1e6
