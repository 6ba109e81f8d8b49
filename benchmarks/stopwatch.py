"""Time that passes, and time of the processor, of the whole process and of one of its threads."""

import threading
import time
from dataclasses import dataclass
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


def _clock_of(name: str | None) -> int | None:
    for thread in threading.enumerate():
        if name is not None and thread.name == name and thread.ident is not None:
            return time.pthread_getcpuclockid(thread.ident)
    return None
