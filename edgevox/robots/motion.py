"""What a body does for a while: a drive, a walk, a grip. Every body's motions are `Motion`s."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

REPORT_EVERY_S = 0.2


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a motion is: 0 to 1, and what is left of it in `unit`, where that is known."""

    part: float
    left: float = 0.0
    unit: str = ""


class Motion(ABC):
    """Ends exactly once: done, or with the error that is raised to whoever waits for it.

    All but `progress` may be used from any thread; that one reads what the body's lock guards.
    """

    def __init__(self) -> None:
        self._ending = threading.Lock()
        self._over = threading.Event()
        self.done = False
        """Whether it is over, for whatever reason."""
        self.error: BaseException | None = None
        """Why it ended before it was done."""

    @abstractmethod
    def progress(self) -> Progress:
        """How far it is."""

    def end(self, error: BaseException | None = None) -> bool:
        """It is over: done, or not because of `error`. True for the first end, the one that counts.

        Whether it stops the body is the business of who moves it.
        """
        with self._ending:
            if self.done:
                return False
            self.error, self.done = error, True
            self._over.set()
            return True

    def check(self) -> None:
        """Raise what it ended with, if that was an error."""
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
