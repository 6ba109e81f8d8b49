"""What a policy must know of the robot to judge a goal."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field


def _nowhere(_x_m: float, _y_m: float) -> str | None:
    return None


def _unknown() -> tuple[float, float] | None:
    return None


@dataclass(frozen=True, slots=True)
class PolicyContext:
    """Asked anew for each goal; metres, map frame.

    `places` are points by name, `place_at` says in which one a point is, `here` is where the robot
    is, None while nobody knows. All are quick.
    """

    places: Callable[[], Mapping[str, tuple[float, float]]] = field(default=dict)
    place_at: Callable[[float, float], str | None] = _nowhere
    here: Callable[[], tuple[float, float] | None] = _unknown
