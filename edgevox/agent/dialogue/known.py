"""What a body knows of itself and its world, for a conversation that answers questions."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime

from edgevox.agent.skills import Skill
from edgevox.core.transforms import Pose2D

PlaceAt = Callable[[float, float], str | None]
"""Returns the place that a point is in; metres, map frame."""


def no_place(_x_m: float, _y_m: float) -> None:
    """The place of every point for a body without places."""


@dataclass(frozen=True, slots=True)
class WayLeft:
    """The rest of a way."""

    metres: float
    """Its length."""
    seconds: float | None
    """The time that it takes; None if that is not known."""


@dataclass(frozen=True, slots=True)
class Known:
    """What a robot knows beside its conversation, for `DialogueSkills`."""

    facts: tuple[Skill, ...] = ()
    """The facts of its body."""
    pose: Callable[[], Pose2D] | None = None
    """Returns its pose; None for a body that has none."""
    place_at: PlaceAt = no_place
    """Returns the place of a point."""
    way_left: Callable[[], WayLeft | None] = lambda: None
    """Returns what is left of the way that it is on; None if that is not known."""
    today: Callable[[], datetime] = datetime.now
    """Returns the date and time where the robot is."""


NOTHING_KNOWN = Known()

_FINE_S, _COARSE_S = 5, 60


def about_s(seconds: float) -> int:
    """A duration as an estimate is told: up to the next 5 seconds, or the next minute."""
    unit = _FINE_S if seconds < 2 * _COARSE_S else _COARSE_S
    return max(unit, unit * math.ceil(seconds / unit))
