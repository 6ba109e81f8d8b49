"""The table with its cubes and bins, and where the cubes are in a person's words.

Metres, map frame: the arm's base is zero, the table's top is the plane z = 0, x points away from
the arm over the table, y to its left.
"""

import math
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

CUBE_SIZE_M = 0.05
CUBE_MASS_KG = 0.05
TABLE = "table"
TABLE_X_M = (-0.35, 0.85)
TABLE_HALF_WIDTH_M = 0.65
TABLE_HEIGHT_M = 0.72
FAR_M = 10.0
"""The room ends here, far beyond what the arm reaches."""

_RANDOM_X_M = (0.36, 0.60)
_RANDOM_Y_M = (-0.20, 0.20)
_RANDOM_YAW_RAD = math.pi / 4
_APART_M = 0.12


@dataclass(frozen=True, slots=True)
class Cube:
    """A cube, its colour (red, green, blue, alpha), and where it lies at the start."""

    name: str
    rgba: tuple[float, float, float, float]
    start: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Bin:
    """An open box around `center`, `half_m` from its middle to its walls' inside."""

    name: str
    rgba: tuple[float, float, float, float]
    center: tuple[float, float]
    half_m: float = 0.12
    wall_m: float = 0.006
    height_m: float = 0.05
    floor_m: float = 0.005

    def contains(self, x_m: float, y_m: float) -> bool:
        """Return whether this point is above its floor."""
        return max(abs(x_m - self.center[0]), abs(y_m - self.center[1])) < self.half_m


CUBES: Mapping[str, Cube] = {
    cube.name: cube
    for cube in (
        Cube("red_cube", (0.85, 0.11, 0.10, 1.0), (0.52, 0.0)),
        Cube("green_cube", (0.10, 0.62, 0.18, 1.0), (0.46, 0.16)),
        Cube("blue_cube", (0.09, 0.28, 0.85, 1.0), (0.46, -0.16)),
    )
}
BINS: Mapping[str, Bin] = {
    one.name: one
    for one in (
        Bin("left_bin", (0.93, 0.68, 0.16, 1.0), (0.40, 0.42)),
        Bin("right_bin", (0.45, 0.35, 0.66, 1.0), (0.40, -0.42)),
    )
}


@dataclass(frozen=True, slots=True)
class Lying:
    """The position and turn of a cube on the table."""

    x_m: float
    y_m: float
    yaw_rad: float


def places(seed: int) -> dict[str, Lying]:
    """Return the cubes' start poses: the standard ones for seed 0, else random ones.

    Random places are on the table between the bins, in reach and with room for the fingers.
    """
    if seed == 0:
        return {cube.name: Lying(*cube.start, 0.0) for cube in CUBES.values()}
    source = random.Random(seed)  # noqa: S311 - repeatable, not secret
    found: dict[str, Lying] = {}
    while len(found) < len(CUBES):
        one = Lying(
            source.uniform(*_RANDOM_X_M),
            source.uniform(*_RANDOM_Y_M),
            source.uniform(-_RANDOM_YAW_RAD, _RANDOM_YAW_RAD),
        )
        if all(math.dist((one.x_m, one.y_m), (o.x_m, o.y_m)) > _APART_M for o in found.values()):
            found[list(CUBES)[len(found)]] = one
    return found


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
