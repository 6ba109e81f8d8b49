"""One motion of the motors: what they follow, and when it has ended."""

from collections.abc import Callable

import numpy as np

from edgevox.robots.motion import Motion, Progress
from edgevox.robots.panda.path import Rows

NO_ROWS: Rows = np.zeros((0, 7))


class ArmMotion(Motion):
    """Follows `rows`, a period each, then waits `least` to `patience` periods until `settled`."""

    def __init__(
        self,
        rows: Rows = NO_ROWS,
        *,
        settled: Callable[[], bool],
        patience: int,
        least: int = 1,
        impatient: BaseException | None = None,
    ) -> None:
        super().__init__()
        self.rows = rows
        self.row = 0
        self.settled = settled
        self.left = patience
        self.least = least
        self.impatient = impatient

    def progress(self) -> Progress:
        return Progress(self.row / len(self.rows) if len(self.rows) else 0.0)
