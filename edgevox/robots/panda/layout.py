"""The layout of table, cubes and bins. Metres, map frame: the arm's base is zero.

The table's top is the plane z = 0, x points away from the arm over the table, y to its left.
"""

import math
import random
from collections.abc import Mapping
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
