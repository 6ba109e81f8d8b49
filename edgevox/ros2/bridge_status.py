"""The bridge's status: the components `executor` and `presence`. Does not import rclpy."""

from collections.abc import Callable
from dataclasses import asdict, dataclass

from edgevox.core.clock import Clock
from edgevox.core.status import (
    ComponentName,
    Finding,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    moves,
    stall,
)


@dataclass(frozen=True, slots=True)
class ExecutorCounts:
    """The condition of the node's threads."""

    stalled_s: float = 0.0
    """Seconds for which one callback has held up all others."""
    failed_callbacks: int = 0
    """Callbacks that raised."""
    lag_s: float = 0.0
    """The longest wait of a callback in the last minute, in seconds."""
    failed_ticks: int = 0
    """Periodic jobs that raised."""
    failed_images: int = 0
    """Pictures that could not be taken."""


class ExecutorComponent:
    """Status of the executor: a callback that holds up the others is a warning, later an error.

    A failed callback is also a warning. `missing` is the reason why the node is not on ROS 2; empty
    if it is.
    """

    name = ComponentName.EXECUTOR

    def __init__(
        self, look: Callable[[], ExecutorCounts], missing: str = "", clock: Clock | None = None
    ) -> None:
        self._look, self._missing = look, missing
        self._failing = RecentIncrease(clock)
        self.checks = (
            HealthCheck("ros2", moves(lambda: look().stalled_s)),
            HealthCheck("rclpy", lambda: missing, vital=False),
        )

    def status(self) -> Status:
        """Return the current status."""
        now = self._look()
        found = stall(now.stalled_s, "a callback holds up all others: the node has")
        if self._missing:
            found.append(Finding(Level.ERROR, f"not on ROS 2: {self._missing}"))
        if self._failing.grew(now.failed_callbacks):
            text = f"a callback failed, {now.failed_callbacks} by now; the log says why"
            found.append(Finding(Level.WARN, text))
        return Status.judged(self.name, found, well="turns", **asdict(now))


@dataclass(frozen=True, slots=True)
class Sharing:
    """The agents that share a namespace."""

    namespace: str
    id: str
    """This agent's id there."""
    others: tuple[str, ...] = ()
    """The other agents, in words."""
    yields: bool = False
    """True if this agent refuses to move because another one is in charge."""

    def status(self) -> Status:
        """Another agent is a warning; to refuse to move for its sake is an error."""
        found = []
        if self.others:
            found.append(Finding(Level.WARN, f"also on {self.namespace}: {', '.join(self.others)}"))
        if self.yields:
            text = "refuses to move while another agent is in charge, unless told to take over"
            found.append(Finding(Level.ERROR, text))
        return Status.judged(
            "presence",
            found,
            well=f"alone on {self.namespace}",
            id=self.id,
            others=len(self.others),
            in_charge=not self.yields,
        )
