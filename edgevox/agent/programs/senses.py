"""What programs ask of the body while they wait and run; a robot without one knows nothing."""

from collections.abc import Callable
from dataclasses import dataclass

from edgevox.agent.skills import Call


def _nowhere() -> Call | None:
    return None


@dataclass(frozen=True, slots=True)
class Senses:
    """`battery` gives the charge left, 0 to 1, or None while that is not known; it must not block.

    It is None for a robot that has no battery. `way_back` gives the call that leads back to where
    the robot is now, None where it does not know.
    """

    battery: Callable[[], float | None] | None = None
    way_back: Callable[[], Call | None] = _nowhere


NO_SENSES = Senses()
