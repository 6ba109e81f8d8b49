"""A received map in the page's form: a picture, one pixel a cell, and its place."""

import base64
import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D
from edgevox.robots.occupancy_map import OccupancyMap
from edgevox.robots.shapes import Circle, Point, Shape, place
from edgevox.robots.world.model import Thing, World

Label = Callable[[str], str]
"""Returns a name's label in the language that is spoken."""


@runtime_checkable
class InWorld(Protocol):
    """Lives in a 2D world that is known, and can say where it will drive."""

    world: World

    def movable_poses(self) -> tuple[Pose2D, ...]: ...

    def way(self) -> tuple[Point, ...]: ...


def scene_of(world: World, label: Label) -> dict[str, Any]:
    """Return the fixed parts of a world, JSON-ready."""
    fixed = [(thing, _shapes(thing, thing.pose, label)) for thing in world.fixed]
    return {
        "bounds": [world.x_min_m, world.y_min_m, world.x_max_m, world.y_max_m],
        "walls": [one for thing, shapes in fixed if thing.is_wall for one in shapes],
        "furniture": [one for thing, shapes in fixed if not thing.is_wall for one in shapes],
        "rooms": [
            {
                "name": room.name,
                "label": label(room.name),
                "outline": _points(room.outline.vertices),
                "goal": list(room.goal),
            }
            for room in world.rooms
        ],
        "radius": world.robot.radius_m,
    }


def pushed(body: InWorld, label: Label) -> list[dict[str, Any]]:
    """The things that can be pushed, where they are now."""
    both = zip(body.world.movable, body.movable_poses(), strict=True)
    return [one for thing, pose in both for one in _shapes(thing, pose, label)]


def path(body: InWorld) -> list[list[float]]:
    """The way that it still has to go."""
    return _points(body.way())


def _shapes(thing: Thing, pose: Pose2D, label: Label) -> list[dict[str, Any]]:
    called = {"name": thing.name, "label": label(thing.spoken)}
    return [{**called, **_shape(place(part, pose))} for part in thing.parts]


def _shape(shape: Shape) -> Mapping[str, Any]:
    if isinstance(shape, Circle):
        return {"circle": [round(one, 3) for one in (*shape.center, shape.radius_m)]}
    return {"points": _points(shape.vertices)}


def _points(points: Sequence[Point]) -> list[list[float]]:
    return [[round(x_m, 3), round(y_m, 3)] for x_m, y_m in points]


GREYS = (0, 128, 255)
"""Greys of an unknown, free and occupied cell; the page chooses the colours."""
BITS = 2


class MapGrid:
    """Makes the picture once for each map. Thread-safe."""

    def __init__(self) -> None:
        self._made: tuple[NDArray[np.uint8] | None, str] = (None, "")

    def as_json(self, grid: OccupancyMap) -> dict[str, Any]:
        """`x`, `y` and `yaw` are its lower left corner in the map frame; metres, radians."""
        cells, png = self._made
        if cells is not grid.cells:
            png = _png(grid.cells)
            self._made = (grid.cells, png)
        origin = grid.origin
        return {
            "png": png,
            "x": round(origin.x_m, 3),
            "y": round(origin.y_m, 3),
            "yaw": round(origin.yaw_rad, 5),
            "resolution": round(grid.resolution_m, 6),
        }


def _png(cells: NDArray[np.uint8]) -> str:
    """Return a PNG in base64; its first row is the upper edge."""
    from PIL import Image  # which only pictures need

    image = Image.fromarray(np.ascontiguousarray(cells[::-1]))
    image.putpalette([grey for grey in GREYS for _ in "rgb"])
    file = io.BytesIO()
    image.save(file, format="PNG", bits=BITS)
    return base64.b64encode(file.getvalue()).decode("ascii")
