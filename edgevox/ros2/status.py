"""What the bridge says of itself: the components `executor` and `presence`. Without rclpy."""

from dataclasses import dataclass
from typing import Protocol

from edgevox.core.clock import Clock
from edgevox.core.lately import Lately
from edgevox.core.status import Check, Finding, Level, Status, moves, stall


class Executes(Protocol):
    """Runs callbacks of ROS 2, or says why it does not."""

    @property
    def missing(self) -> str:
        """Why it is not on ROS 2; empty if it is."""

    @property
    def stalled_s(self) -> float:
        """For how long a callback has held up all others."""

    @property
    def failed(self) -> int:
        """Callbacks that raised."""

    @property
    def lag_s(self) -> float:
        """The longest that callbacks had to wait in the last minute."""

    @property
    def failed_ticks(self) -> int:
        """Jobs of the ticker that raised."""

    @property
    def failed_images(self) -> int:
        """Pictures that could not be taken."""


class Executor:
    """A callback that holds up the others is a warning, later an error; so is one that failed."""

    name = "executor"

    def __init__(self, bridge: Executes, clock: Clock | None = None) -> None:
        self._bridge = bridge
        self._failing = Lately(clock)
        self.checks = (
            Check("ros2", moves(lambda: bridge.stalled_s)),
            Check("rclpy", lambda: bridge.missing, vital=False),
        )

    def status(self) -> Status:
        """How it is now."""
        bridge = self._bridge
        stalled_s, failed = bridge.stalled_s, bridge.failed
        found = stall(stalled_s, "a callback holds up all others: nothing has")
        if bridge.missing:
            found.append(Finding(Level.ERROR, f"not on ROS 2: {bridge.missing}"))
        if self._failing.grew(failed):
            text = f"a callback failed, {failed} by now; the log says why"
            found.append(Finding(Level.WARN, text))
        return Status.judged(
            self.name,
            found,
            well="turns",
            stalled_s=stalled_s,
            lag_s=bridge.lag_s,
            failed_callbacks=failed,
            failed_ticks=bridge.failed_ticks,
            failed_images=bridge.failed_images,
        )


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
