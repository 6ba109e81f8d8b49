"""The `shape` of an object in a world file, as IR-SIM means it."""

import math
import random
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import pymunk.autogeometry
from pydantic import AfterValidator, BeforeValidator

from edgevox.core.files.validation import wrong
from edgevox.core.transforms import Pose2D
from edgevox.robots import shapes
from edgevox.robots.shapes import Line, Point, Polygon, Shape, area, is_convex, place
from edgevox.robots.world.fields import (
    XY,
    Flag,
    NotNegative,
    Positive,
    ThreeOrMore,
    WorldPart,
    chosen,
    listed,
    one_or_more,
    words,
)


class ShapePart(WorldPart):
    """Any shape. `pose` is where it stands in a compound."""

    also: ClassVar[frozenset[str]] = frozenset({"name"})
    pose: ThreeOrMore = (0.0, 0.0, 0.0)

    def made(self, dice: random.Random) -> tuple[Shape, ...]:
        """Return its parts in the object's own frame; `dice` decides the random ones."""
        raise NotImplementedError


def _sizes(sizes: Point) -> Point:
    low, high = sizes
    if not 1e-3 <= low <= high:
        raise ValueError(f"a number from 0.001 to {high:g} first")
    return sizes


class _CirclePart(ShapePart):
    radius: Positive = 0.2
    center: XY = (0.0, 0.0)
    wheelbase: NotNegative = 0.0
    random_shape: Flag = False
    radius_range: Annotated[XY, AfterValidator(_sizes)] = (0.1, 1.0)

    def made(self, dice: random.Random) -> tuple[Shape, ...]:
        x, y = self.center
        radius = dice.uniform(*self.radius_range) if self.random_shape else self.radius
        return (shapes.Circle((x + self.wheelbase / 2, y), radius),)


class _RectanglePart(ShapePart):
    """About its middle, or about the middle of its rear axle."""

    length: Positive = 1.0
    width: Positive = 1.0
    wheelbase: NotNegative = 0.0

    def made(self, dice: random.Random) -> tuple[Shape, ...]:  # noqa: ARG002
        x, y, shift = self.length / 2, self.width / 2, self.wheelbase / 2
        return (Polygon(((shift - x, -y), (shift + x, -y), (shift + x, y), (shift - x, y))),)


def _not_random(flag: bool) -> bool:
    if flag:
        raise ValueError("false: only circles may be random")
    return flag


def _ring(vertices: tuple[Point, ...]) -> tuple[Point, ...]:
    """Counter-clockwise, each corner once."""
    if vertices[0] == vertices[-1]:
        vertices = vertices[:-1]
    if len(vertices) < 3 or math.isclose(area(vertices), 0.0, abs_tol=1e-9):
        raise ValueError("an area above 0")
    return vertices if area(vertices) > 0 else vertices[::-1]


class _CorneredPart(ShapePart):
    """A shape with corners, which IR-SIM can also make at random."""

    also: ClassVar[frozenset[str]] = words(
        "name is_convex center_range avg_radius_range irregularity_range spikeyness_range "
        "num_vertices_range number"
    )
    random_shape: Annotated[Flag, AfterValidator(_not_random)] = False


class _PolygonPart(_CorneredPart):
    vertices: Annotated[
        tuple[XY, ...], listed("a list of 3 to 1000 [x, y] points", 3, 1000), AfterValidator(_ring)
    ]

    def made(self, dice: random.Random) -> tuple[Shape, ...]:  # noqa: ARG002
        return (Polygon(self.vertices),)


class _LinePart(_CorneredPart):
    vertices: Annotated[tuple[XY, ...], listed("a list of 2 to 1000 [x, y] points", 2, 1000)]

    def made(self, dice: random.Random) -> tuple[Shape, ...]:  # noqa: ARG002
        return (Line(self.vertices),)


_SIMPLE = {"circle": _CirclePart, "rectangle": _RectanglePart, "polygon": _PolygonPart}


class _CompoundPart(ShapePart):
    parts: Annotated[
        tuple[Annotated[ShapePart, chosen(_SIMPLE, "")], ...],
        listed("a list of at least 1 shape", 1),
        BeforeValidator(one_or_more),
    ]

    def made(self, dice: random.Random) -> tuple[Shape, ...]:
        return tuple(
            place(shape, Pose2D(*member.pose[:3]))
            for member in self.parts
            for shape in member.made(dice)
        )


def _alone(data: Any) -> Any:
    if isinstance(data, Mapping) and "pose" in data:
        raise wrong(("pose",), data["pose"], "no pose: only the parts of a compound have one")
    return data


AnyShape = Annotated[
    ShapePart,
    chosen({**_SIMPLE, "linestring": _LinePart, "compound": _CompoundPart}, "circle"),
    BeforeValidator(_alone),
]


def hull(polygon: Polygon) -> Polygon:
    """The polygon itself if it is convex, else its convex hull."""
    if is_convex(polygon):
        return polygon
    corners = pymunk.autogeometry.to_convex_hull(list(polygon.vertices), 1e-4)
    return Polygon(_ring(tuple((float(c[0]), float(c[1])) for c in corners[:-1])))
