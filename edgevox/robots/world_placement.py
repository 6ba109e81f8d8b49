"""Where the objects of one entry of a world file stand: IR-SIM's `state` and `distribution`."""

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import PlainValidator, TypeAdapter

from edgevox.core.transforms import Pose2D, distance_on_floor, to_map
from edgevox.core.validation import wrong
from edgevox.robots.world_fields import (
    NotNegative,
    Positive,
    ThreeOrMore,
    TwoOrMore,
    WorldPart,
    chosen,
)

Area = tuple[Pose2D, Pose2D]
"""The world less a margin, corner to corner."""
_TRIES = 1000
_ONE: TypeAdapter[tuple[float, ...]] = TypeAdapter(TwoOrMore)
_SEVERAL: TypeAdapter[tuple[tuple[float, ...], ...]] = TypeAdapter(tuple[TwoOrMore, ...])


def _poses(value: Any) -> tuple[Pose2D, ...]:
    if not isinstance(value, list) or not value:
        raise ValueError("[x, y, heading] or a list of them")
    several = isinstance(value[0], list)
    found = _SEVERAL.validate_python(value) if several else (_ONE.validate_python(value),)
    return tuple(Pose2D(*(*numbers, 0.0)[:3]) for numbers in found)


Poses = Annotated[tuple[Pose2D, ...], PlainValidator(_poses)]
"""One pose that all share, or one each; the last one is that of all that are left."""


@dataclass(frozen=True)
class Placing:
    """What is to be placed: so many objects, with the poses that are written, in an area."""

    written: Sequence[Pose2D]
    number: int
    area: Area
    dice: random.Random


class Distribution(WorldPart):
    """How the objects of an entry are placed; as is written, unless told otherwise."""

    also: ClassVar[frozenset[str]] = frozenset({"name", "3d"})

    def poses(self, asked: Placing) -> list[Pose2D]:
        """A pose for each object. Raises `ValidationError` where there is no room."""
        return [asked.written[min(i, len(asked.written) - 1)] for i in range(asked.number)]


class _OnCircle(Distribution):
    """Evenly on a circle, looking at its middle."""

    radius: Positive | None = None
    center: TwoOrMore | None = None

    def poses(self, asked: Placing) -> list[Pose2D]:
        low, high = asked.area
        radius = self.radius or min(high.x_m - low.x_m, high.y_m - low.y_m) / 2
        x, y = (self.center or ((low.x_m + high.x_m) / 2, (low.y_m + high.y_m) / 2))[:2]
        angles = [2 * math.pi * i / asked.number for i in range(asked.number)]
        return [Pose2D(*to_map((radius, 0.0), Pose2D(x, y, a)), a - math.pi) for a in angles]


class _AtRandom(Distribution):
    """Anywhere within a range, apart from each other."""

    range_low: ThreeOrMore | None = None
    range_high: ThreeOrMore | None = None
    min_distance: NotNegative = 1.0

    def poses(self, asked: Placing) -> list[Pose2D]:
        low, high = ((corner.x_m, corner.y_m, corner.yaw_rad) for corner in asked.area)
        ranges = list(zip((self.range_low or low)[:3], (self.range_high or high)[:3], strict=True))
        found: list[Pose2D] = []
        for _ in range(asked.number):
            found.append(self._far_from(found, ranges, asked.dice))
        return found

    def _far_from(
        self, others: Sequence[Pose2D], ranges: list[tuple[float, float]], dice: random.Random
    ) -> Pose2D:
        for _ in range(_TRIES):
            pose = Pose2D(*(dice.uniform(a, b) for a, b in ranges))
            apart = (distance_on_floor(pose, other) for other in others)
            if all(one >= self.min_distance for one in apart):
                return pose
        expected = "a smaller distance: there is no room for so many"
        raise wrong(("distribution", "min_distance"), self.min_distance, expected)


AnyDistribution = Annotated[
    Distribution,
    chosen({"manual": Distribution, "circle": _OnCircle, "random": _AtRandom}, "manual"),
]
