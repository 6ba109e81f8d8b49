"""Reads the `shape` of an object in a world file."""

import math
import random

import pymunk.autogeometry

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.shapes import Circle, Line, Point, Polygon, Shape, area, is_convex, place
from edgevox.robots.world_fields import Fields, as_number, as_numbers

_RANDOM_POLYGON = {
    "center_range",
    "avg_radius_range",
    "irregularity_range",
    "spikeyness_range",
    "num_vertices_range",
    "number",
}
_KEYS = {
    "circle": {"name", "radius", "center", "random_shape", "radius_range", "wheelbase"},
    "rectangle": {"name", "length", "width", "wheelbase"},
    "polygon": {"name", "vertices", "random_shape", "is_convex"} | _RANDOM_POLYGON,
    "linestring": {"name", "vertices", "random_shape", "is_convex"} | _RANDOM_POLYGON,
    "compound": {"name", "parts"},
}


def read_shape(fields: Fields, dice: random.Random) -> tuple[Shape, ...]:
    """The parts of one shape in its object's own frame. A random radius comes from `dice`."""
    name = fields.text("name", "circle").lower()
    if name not in _KEYS:
        raise InvalidValue(fields.path("name"), name, "one of " + ", ".join(_KEYS))
    fields.check_keys(_KEYS[name] | ({"pose"} if ".parts[" in fields.where else set()))
    match name:
        case "circle":
            return (_circle(fields, dice),)
        case "rectangle":
            return (_rectangle(fields),)
        case "polygon":
            return (_polygon(fields),)
        case "linestring":
            return (Line(_vertices(fields, 2)),)
        case _:
            return _compound(fields, dice)


def hull(polygon: Polygon) -> Polygon:
    """The polygon itself if it is convex, else its convex hull."""
    if is_convex(polygon):
        return polygon
    corners = pymunk.autogeometry.to_convex_hull(list(polygon.vertices), 1e-4)
    return _counter_clockwise(tuple((float(c[0]), float(c[1])) for c in corners[:-1]))


def _circle(fields: Fields, dice: random.Random) -> Circle:
    x, y = fields.point("center") if "center" in fields else (0.0, 0.0)
    x += fields.number("wheelbase", 0.0, low=0.0) / 2
    if not fields.flag("random_shape"):
        return Circle((x, y), fields.positive("radius", 0.2))
    low, high = 0.1, 1.0
    if "radius_range" in fields:
        low, high = fields.point("radius_range")
    as_number(fields.path("radius_range"), low, 1e-3, high)
    return Circle((x, y), dice.uniform(low, high))


def _rectangle(fields: Fields) -> Polygon:
    x = fields.positive("length", 1.0) / 2
    y = fields.positive("width", 1.0) / 2
    shift = fields.number("wheelbase", 0.0, low=0.0) / 2
    return Polygon(((shift - x, -y), (shift + x, -y), (shift + x, y), (shift - x, y)))


def _polygon(fields: Fields) -> Polygon:
    vertices = _vertices(fields, 3)
    if vertices[0] == vertices[-1]:
        vertices = vertices[:-1]
    if len(vertices) < 3 or math.isclose(area(vertices), 0.0, abs_tol=1e-9):
        raise InvalidValue(fields.path("vertices"), fields.get("vertices"), "an area above 0")
    return _counter_clockwise(vertices)


def _counter_clockwise(vertices: tuple[Point, ...]) -> Polygon:
    return Polygon(vertices if area(vertices) > 0 else vertices[::-1])


def _vertices(fields: Fields, least: int) -> tuple[Point, ...]:
    if fields.flag("random_shape"):
        raise InvalidValue(fields.path("random_shape"), True, "false: only circles may be random")
    return fields.points("vertices", least)


def _compound(fields: Fields, dice: random.Random) -> tuple[Shape, ...]:
    parts: list[Shape] = []
    for part in fields.each("parts"):
        if part.get("name") not in ("circle", "rectangle", "polygon"):
            raise InvalidValue(part.path("name"), part.get("name"), "circle, rectangle or polygon")
        pose = Pose2D(0.0, 0.0, 0.0)
        if "pose" in part:
            pose = Pose2D(*as_numbers(part.path("pose"), part.get("pose"), 3)[:3])
        parts += [place(shape, pose) for shape in read_shape(part, dice)]
    if not parts:
        raise InvalidValue(fields.path("parts"), fields.get("parts"), "a list of at least 1 shape")
    return tuple(parts)
