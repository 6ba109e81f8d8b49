"""What a body tells the agent of itself and its world: for answers, and for programs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime

from edgevox.agent.skills import Call, Skill
from edgevox.core.reason import NO_REASON, Reason
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


def _no_way() -> None:
    """What a body knows of a way without knowing any."""


VALUE = "value"
"""What the templates of a condition call the number that is said in it."""


@dataclass(frozen=True, slots=True)
class StateCondition:
    """Something of the robot that orders can wait for: "when you are docked, beep"."""

    sentences: Mapping[str, Sequence[str]]
    """Templates for it, without "when", by language; `VALUE` may be a slot for a number."""
    is_so: Callable[[float | None], bool]
    """Returns whether it is so now, with the number that was said; false while that is unknown.
    Must not block."""


@dataclass(frozen=True, slots=True)
class Known:
    """What a robot knows beside its conversation; by default nothing."""

    facts: tuple[Skill, ...] = ()
    """The facts of its body."""
    pose: Callable[[], Pose2D] | None = None
    """Returns its pose; None for a body that has none."""
    place_at: PlaceAt = no_place
    """Returns the place of a point."""
    way_left: Callable[[], WayLeft | None] = _no_way
    """Returns what is left of the way that it is on; None if that is not known."""
    way_back: Callable[[], Call | None] = _no_way
    """Returns the call that leads back to the pose now; None if the robot does not know it."""
    battery: Callable[[], float | None] | None = None
    """Returns the charge from 0 to 1, or None while it is unknown. Must not block. None for a robot
    without a battery."""
    conditions: Mapping[str, StateCondition] = field(default_factory=dict)
    """What else of the robot orders can wait for, by name."""
    unheard: Callable[[], Reason] = lambda: NO_REASON
    """Returns the sentence that the robot was told to stop and is not heard; empty if it is."""
    today: Callable[[], datetime] = datetime.now
    """Returns the date and time where the robot is."""


NOTHING_KNOWN = Known()

_FINE_S, _COARSE_S = 5, 60


def about_s(seconds: float) -> int:
    """A duration as an estimate is told: up to the next 5 seconds, or the next minute."""
    unit = _FINE_S if seconds < 2 * _COARSE_S else _COARSE_S
    return max(unit, unit * math.ceil(seconds / unit))
