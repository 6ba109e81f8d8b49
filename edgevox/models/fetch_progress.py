"""How a fetch shows how far it is: a bar on a terminal, now and then a line elsewhere."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol, TextIO

import rich.console
import rich.progress

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.files.text import one_line


class FetchProgress(Protocol):
    """Watches one model after the other being fetched; counts are in bytes."""

    def begin(self, name: str, total: int) -> None:
        """`total` bytes of a model are missing and being fetched."""

    def at(self, done: int) -> None:
        """So much of it is there."""

    def end(self) -> None:
        """It is whole."""

    def note(self, text: str) -> None:
        """Something that a person may want to know."""


class SilentProgress:
    """Shows nothing."""

    def begin(self, name: str, total: int) -> None:
        """Say nothing."""

    def at(self, done: int) -> None:
        """Say nothing."""

    def end(self) -> None:
        """Say nothing."""

    def note(self, text: str) -> None:
        """Say nothing."""


class ProgressLines:
    """A line at the start, at the end, and every few seconds between."""

    def __init__(self, out: TextIO, clock: Clock | None = None, every_s: float = 5.0) -> None:
        self._out = out
        self._clock = clock or SystemClock()
        self._every_s = every_s
        self._name, self._total, self._started, self._said = "", 0, 0.0, 0.0

    def begin(self, name: str, total: int) -> None:
        """A line with what is to come."""
        self._name, self._total = name, total
        self._started = self._said = self._clock.now()
        self.note(f"{name}: fetching {megabytes(total)}")

    def at(self, done: int) -> None:
        """A line, if the last one is long ago."""
        if self._clock.now() - self._said >= self._every_s:
            self._said = self._clock.now()
            self.note(f"{self._name}: {megabytes(done)} of {megabytes(self._total)}")

    def end(self) -> None:
        """A line with how long it took."""
        self.note(f"{self._name}: there after {self._clock.now() - self._started:.0f} s")

    def note(self, text: str) -> None:
        """A line."""
        self._out.write(f"{one_line(text)}\n")
        self._out.flush()


class ProgressBars:
    """One bar a model, on a terminal."""

    def __init__(self, progress: rich.progress.Progress) -> None:
        self._progress = progress
        self._task: rich.progress.TaskID | None = None

    def begin(self, name: str, total: int) -> None:
        """Add a bar."""
        self._task = self._progress.add_task(name, total=total)

    def at(self, done: int) -> None:
        """Move the bar."""
        if self._task is not None:
            self._progress.update(self._task, completed=done)

    def end(self) -> None:
        """Fill the bar."""
        if self._task is not None:
            total = self._progress.tasks[self._task].total
            self._progress.update(self._task, completed=total)

    def note(self, text: str) -> None:
        """A line above the bars."""
        self._progress.console.print(one_line(text), markup=False, highlight=False)


@contextmanager
def shown_on(out: TextIO) -> Iterator[FetchProgress]:
    """Bars if `out` is a terminal, lines if not."""
    if not out.isatty():
        yield ProgressLines(out)
        return
    columns = (
        rich.progress.TextColumn("{task.description}"),
        rich.progress.BarColumn(),
        rich.progress.DownloadColumn(),
        rich.progress.TransferSpeedColumn(),
        rich.progress.TimeRemainingColumn(),
    )
    console = rich.console.Console(file=out)  # noqa: TID251 - its lines stand above the bars
    with rich.progress.Progress(*columns, console=console) as progress:
        yield ProgressBars(progress)


def megabytes(size: int) -> str:
    """A size for people, in megabytes."""
    return f"{size / 1e6:.1f} MB" if size < 1e7 else f"{size / 1e6:.0f} MB"
