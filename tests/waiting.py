"""How tests wait: for what comes, by its arrival, and by looking again for what tells nobody.

`guards.HUNG_S` ends a wait only where nothing would ever come. Nothing of edgevox imported: the
peers on ROS 2, which have never heard of it, wait so, too.
"""

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from guards import HUNG_S

T = TypeVar("T")
LOOK_S = 0.02


class Heard(Generic[T]):
    """What came, one after another, when each did, and a way to wait for one. Thread-safe.

    Once `over`, nothing more comes, and nobody waits for it.
    """

    def __init__(self) -> None:
        self.messages: list[T] = []
        self.times: list[float] = []
        self._over = False
        self._arrived = threading.Condition()

    def add(self, message: T) -> None:
        with self._arrived:
            self.messages.append(message)
            self.times.append(time.monotonic())
            self._arrived.notify_all()

    def over(self) -> None:
        with self._arrived:
            self._over = True
            self._arrived.notify_all()

    def wait_for(
        self, wanted: Callable[[T], object], timeout_s: float = HUNG_S, since: int = 0
    ) -> T:
        """The first message from number `since` on that is wanted; fails loudly if none comes."""

        def found() -> list[T]:
            return [one for one in self.messages[since:] if wanted(one)]

        with self._arrived:
            came = self._arrived.wait_for(lambda: found() or self._over, timeout_s) and found()
            assert came, f"not heard within {timeout_s} s; heard {self.messages[-20:]}"
            return came[0]

    def wait_until(self, true: Callable[[], object], timeout_s: float = HUNG_S) -> None:
        """Until this is true of what was heard."""
        with self._arrived:
            came = self._arrived.wait_for(true, timeout_s)
            assert came, f"not within {timeout_s} s; heard {self.messages[-20:]}"


def wait_until(look: Callable[[], T], what: str = "it", timeout_s: float = HUNG_S) -> T:
    """The first truth that `look` finds of something that has no event to wait for."""
    pause, deadline_s = threading.Event(), time.monotonic() + timeout_s
    while not (found := look()):
        assert time.monotonic() < deadline_s, f"{what} did not come within {timeout_s} s"
        pause.wait(LOOK_S)
    return found
