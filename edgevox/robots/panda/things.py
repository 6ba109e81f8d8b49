"""The cubes' places in a person's words. Metres, map frame."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from edgevox.robots.panda.layout import BINS, CUBE_SIZE_M, TABLE, Bin

FLOOR, HAND = "floor", "hand"
_ROOM_M = 0.085
_ON_M = 0.035
_LEVEL_M = 0.015
_GRID = 5


@dataclass(frozen=True, slots=True)
class Placed:
    """The middle of a cube, and how it is turned about the vertical (-pi/4 to pi/4)."""

    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float = 0.0

    def away_m(self, other: "Placed") -> float:
        """Return the distance of two middles, seen from above."""
        return math.dist((self.x_m, self.y_m), (other.x_m, other.y_m))


Things = Mapping[str, Placed]
"""The cubes' places by name."""


def where(name: str, things: Things, held: str | None) -> str:
    """The hand, the cube under it, a bin, the table, or the floor."""
    if name == held:
        return HAND
    one = things[name]
    if one.z_m < 0.0:
        return FLOOR
    lower = below(name, things)
    inside = (box.name for box in BINS.values() if box.contains(one.x_m, one.y_m))
    return lower or next(inside, TABLE)


def below(name: str, things: Things) -> str | None:
    """The cube that this one stands on."""
    one = things[name]
    return next((o for o, other in things.items() if o != name and _on(one, other)), None)


def on_top(name: str, things: Things) -> str | None:
    """The cube that stands on this one."""
    one = things[name]
    return next((o for o, other in things.items() if o != name and _on(other, one)), None)


def free_spot(name: str, box: Bin, things: Things) -> tuple[float, float] | None:
    """Return the roomiest place in this bin for that cube; None if it is full."""
    reach = box.half_m - CUBE_SIZE_M - 0.005
    points = sorted(_grid(box.center, reach), key=lambda p: math.dist(p, box.center))
    return _roomiest(name, points, things)


def free_table(name: str, things: Things, start: tuple[float, float]) -> tuple[float, float] | None:
    """A free spot on the table: where this cube was at the start, or another."""
    if _room(name, start, things) >= _ROOM_M:
        return start
    return _roomiest(name, list(_grid((0.48, 0.0), 0.14)), things)


def _on(upper: Placed, lower: Placed) -> bool:
    rise = upper.z_m - lower.z_m
    return upper.away_m(lower) < _ON_M and abs(rise - CUBE_SIZE_M) < _LEVEL_M


def _grid(center: tuple[float, float], reach_m: float) -> Iterator[tuple[float, float]]:
    for i in range(_GRID):
        for j in range(_GRID):
            yield (
                center[0] + reach_m * (2 * i / (_GRID - 1) - 1),
                center[1] + reach_m * (2 * j / (_GRID - 1) - 1),
            )


def _roomiest(
    name: str, points: list[tuple[float, float]], things: Things
) -> tuple[float, float] | None:
    best = max(points, key=lambda point: min(_room(name, point, things), 2 * _ROOM_M))
    return best if _room(name, best, things) >= _ROOM_M else None


def _room(name: str, point: tuple[float, float], things: Things) -> float:
    """Return the distance from this point to the nearest other cube."""
    others = (other for o, other in things.items() if o != name)
    return min((math.dist(point, (o.x_m, o.y_m)) for o in others), default=math.inf)
