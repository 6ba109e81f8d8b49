"""What the bridge says of itself: the components `executor` and `presence`. Without rclpy."""

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
    """How ROS 2's callbacks are served: for how long one has held up all others, how many raised,
    the longest that one had to wait in the last minute; what failed beside them.
    """

    stalled_s: float = 0.0
    failed_callbacks: int = 0
    lag_s: float = 0.0
    failed_ticks: int = 0
    failed_images: int = 0


class ExecutorComponent:
    """A callback that holds up the others is a warning, later an error; so is one that failed.

    `missing` says why it is not on ROS 2; empty if it is.
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
        """How it is now."""
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
    """Who shares a namespace: the agent's own id there, the `others` in words, and whether it
    `yields`, which is to refuse to move because one of them is in charge.
    """

    namespace: str
    id: str
    others: tuple[str, ...] = ()
    yields: bool = False

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
