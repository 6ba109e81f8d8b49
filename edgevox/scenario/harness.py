"""Where a scenario plays: what its runner needs of it."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from edgevox.scenario.scenario_judge import Seen


class Harness(Protocol):
    """A robot that is given stimuli and watched. Stimuli raise `EdgeVoxError` if refused."""

    @property
    def time_s(self) -> float:
        """The robot's time."""

    def say(self, text: str, timeout_s: float) -> None:
        """Say it, and wait until it is answered or the timeout is over; goals may still run."""

    def interrupt(self, timeout_s: float) -> None:
        """Stop everything."""

    def run(self, skill: str, arguments: Mapping[str, Any]) -> None:
        """Start a skill."""

    def steer(self, linear_m_s: float, angular_rad_s: float) -> None:
        """One velocity of a stream."""

    def let_pass(self, seconds: float) -> Sequence[Seen]:
        """Let time pass; what was seen in it."""

    def look(self) -> Sequence[Seen]:
        """What was seen since the last time."""
