"""The senses of the body that programs use while they wait and run."""

from collections.abc import Callable
from dataclasses import dataclass

from edgevox.agent.skills import Call


def _nowhere() -> Call | None:
    return None


@dataclass(frozen=True, slots=True)
class Senses:
    """Senses of a body; by default those of a robot that knows nothing."""

    battery: Callable[[], float | None] | None = None
    """Returns the charge from 0 to 1, or None while it is unknown. Must not block. None for a robot
    without a battery."""
    way_back: Callable[[], Call | None] = _nowhere
    """Returns the call that leads back to the pose now; None if the robot does not know it."""


NO_SENSES = Senses()
