"""The base of every body's motions, such as a drive, a walk or a grip."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

REPORT_EVERY_S = 0.2


@dataclass(frozen=True, slots=True)
class Progress:
    """The progress of a motion."""

    part: float
    """The share that is done, 0 to 1."""
    left: float = 0.0
    """The rest, in `unit`, if that is known."""
    unit: str = ""

    def as_values(self) -> dict[str, float | str]:
        """The progress, as a skill reports it."""
        return {"progress": round(self.part, 3), "left": round(self.left, 3), "unit": self.unit}


class Motion(ABC):
    """A motion that ends exactly once: done, or with the error that is raised to its waiter.

    All methods but `progress` may be used from any thread; `progress` reads data that the body's
    lock guards.
    """

    def __init__(self) -> None:
        self._ending = threading.Lock()
        self._over = threading.Event()
        self.done = False
        """Whether it is over, for any reason."""
        self.error: BaseException | None = None
        """The reason why it ended early; None if it was done."""

    @abstractmethod
    def progress(self) -> Progress:
        """Return the progress."""

    def end(self, error: BaseException | None = None) -> bool:
        """End the motion: done, or early with `error`. Return whether this was the first end.

        Only the first end counts. Stopping the body is up to its mover.
        """
        with self._ending:
            if self.done:
                return False
            self.error, self.done = error, True
            self._over.set()
            return True

    def check(self) -> None:
        """Raise the error that it ended with, if any."""
        if self.error is not None:
            raise self.error

    def wait_for(self, most_s: float) -> bool:
        """Block until it is over, no longer than that; whether it is over, for whatever reason."""
        return self._over.wait(most_s)

    def wait(self, report: Callable[[], object]) -> None:
        """Block until it is over, calling `report` five times a second; raises as `check`."""
        while not self._over.wait(REPORT_EVERY_S):
            report()
        self.check()
