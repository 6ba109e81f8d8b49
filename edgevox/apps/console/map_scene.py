"""What stands still on the map of a 2D robot, and what of it can be pushed, as a page draws it.

Metres, map frame.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from edgevox.core.transforms import Pose2D
from edgevox.robots.shapes import Circle, Point, Shape, place
from edgevox.robots.world_model import Thing, World

Label = Callable[[str], str]
"""What a name is called in the language that is spoken."""


@runtime_checkable
class InWorld(Protocol):
    """Lives in a 2D world that is known, and can say where it will drive."""

    world: World

    def movable_poses(self) -> tuple[Pose2D, ...]: ...

    def way(self) -> tuple[Point, ...]: ...


def scene_of(world: World, label: Label) -> dict[str, Any]:
    """What stays where it is, JSON-ready."""
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
