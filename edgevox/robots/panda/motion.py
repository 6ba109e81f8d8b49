"""One motion of the motors: what they follow, and when it has ended."""

import threading
from collections.abc import Callable

import numpy as np

from edgevox.robots.panda.path import Rows

NO_ROWS: Rows = np.zeros((0, 7))


class Motion:
    """Follows `rows`, a period each, then waits `least` to `patience` periods until `settled`.

    It ends once: with nothing, or with the error to raise to whoever waits on `done`.
    """

    def __init__(
        self,
        rows: Rows = NO_ROWS,
        *,
        settled: Callable[[], bool],
        patience: int,
        least: int = 1,
        impatient: BaseException | None = None,
    ) -> None:
        self.rows = rows
        self.row = 0
        self.settled = settled
        self.left = patience
        self.least = least
        self.impatient = impatient
        self.error: BaseException | None = None
        self.done = threading.Event()

    @property
    def progress(self) -> float:
        """How much of it is behind, 0 to 1."""
        return self.row / len(self.rows) if len(self.rows) else 0.0

    def end(self, error: BaseException | None = None) -> None:
        """It is over."""
        if not self.done.is_set():
            self.error = error
            self.done.set()
