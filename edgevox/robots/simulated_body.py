"""How a body that is simulated is switched on and off, whatever simulates it."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self

from edgevox.agent.reasons import called_off


class SimulatedBody(ABC):
    """Runs from `start` to `close`, and for so long in a ``with``."""

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @abstractmethod
    def start(self) -> None:
        """Let time pass in its world."""

    @abstractmethod
    def halt(self, reason: str) -> bool:
        """See `Body.halt`."""

    def close(self) -> None:
        """Stop moving, and join all threads. What runs ends as cancelled."""
        self.halt(str(called_off("switched_off")))
        self._close()

    @abstractmethod
    def _close(self) -> None:
        """Join all threads: it is halted."""
