"""What a policy must know of the robot to judge a goal."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from edgevox.core.transforms import Pose2D

Spot = tuple[float, float]


def _nowhere(_x_m: float, _y_m: float) -> str | None:
    return None


def _unknown() -> Pose2D | None:
    return None


def _meant(_name: str) -> str | None:
    return None


@dataclass(frozen=True, slots=True)
class PolicyContext:
    """Asked anew for each goal; metres, map frame.

    `places` are points of the robot's map by name, `taught` those that it was told the names of.
    `place_at` says in which place of the map a point is, `here` is where the robot is, None while
    nobody knows. `place_meant` gives the place of the map that a name stands for in any language.
    All are quick.
    """

    places: Callable[[], Mapping[str, Spot]] = field(default=dict)
    place_at: Callable[[float, float], str | None] = _nowhere
    here: Callable[[], Pose2D | None] = _unknown
    taught: Callable[[], Mapping[str, Spot]] = field(default=dict)
    place_meant: Callable[[str], str | None] = _meant

    @property
    def names(self) -> Collection[str]:
        """All names that it goes by."""
        return (*self.places(), *self.taught())
