"""A body as the console's page sees and steers it, whatever body it is, and its world or map.

`live` has the moving parts, which a page draws 15 times a second: exactly the body's own. Metres
and radians, map frame. A value that is unknown at the moment is None.
"""

import base64
import io
import zlib
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.policy import Guard
from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import TO_POINT
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock
from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import (
    Body,
    HasCamera,
    HasLidar,
    HasPicture,
    HasPlaces,
    HasPose,
    LidarScan,
    OccupancyMap,
    ReceivesMap,
    ReceivesPictures,
    RemembersPlaces,
    TakesVelocity,
    charge_of,
)
from edgevox.robots.limits import Steering
from edgevox.robots.places.skills import REMEMBER
from edgevox.robots.shapes import Circle, Point, Shape, place
from edgevox.robots.world.model import Thing, World

log = get_logger(__name__)

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


MOST_POINTS = 360
"""The most points of a lidar that are shown; of more beams, every second or third is."""
WIDE_OPEN_M = 0.08
"""The widest opening of the arm's hand."""


@runtime_checkable
class HasJoints(Protocol):
    """Turns in joints."""

    def joints(self) -> Mapping[str, tuple[float, float, float]]:
        """The angle of each joint and its two limits, radians."""


def live(body: Body, label: Label) -> dict[str, Any]:
    """Return the body's current state, JSON-ready."""
    state = body.state()
    pose = _pose(body)
    found: dict[str, Any] = {"time": state.get("time"), "goal": state.get("goal")}
    if isinstance(body, HasPose):
        found |= {"pose": _as_json(pose), "velocity": state.get("velocity") if pose else None}
    if isinstance(body, HasLidar) and pose:
        found["lidar"] = _lidar(body, pose)
    if isinstance(body, InWorld):
        found |= {"path": path(body), "furniture": pushed(body, label)}
    if (charge := charge_of(body)) is not None:
        found["battery"] = {"level": round(charge, 4)}
    if isinstance(body, HasJoints):
        found["joints"] = [
            {"name": name, "value": round(angle, 4), "lower": low, "upper": high}
            for name, (angle, low, high) in body.joints().items()
        ]
    return found | _hand(state, label)


def _hand(state: Mapping[str, Any], label: Label) -> dict[str, Any]:
    """Return the held thing and the things in reach, for a body whose state has them."""
    if "gripper_width" not in state:
        return {}
    held = state["held"]
    things = [
        {"name": name, "label": label(name), "held": name == held, **point}
        for name, point in state["objects"].items()
    ]
    width = min(state["gripper_width"] / WIDE_OPEN_M, 1.0)
    return {"hand": {"open": round(width, 3), "holding": held}, "things": things}


def _pose(body: Body) -> Pose2D | None:
    if not isinstance(body, HasPose):
        return None
    try:
        return body.pose()
    except SkillFailed:  # nothing is heard of it
        return None


def _as_json(pose: Pose2D | None) -> dict[str, float] | None:
    if pose is None:
        return None
    return {"x": round(pose.x_m, 3), "y": round(pose.y_m, 3), "yaw": round(pose.yaw_rad, 4)}


def _lidar(body: HasLidar, pose: Pose2D) -> list[float]:
    """Return the ends of the beams that hit something, x and y in turn."""
    try:
        scan = body.scan()
    except SkillFailed:  # such as a sensor that is silent
        return []
    return _ends(scan, pose)


def _ends(scan: LidarScan, pose: Pose2D) -> list[float]:
    ranges = np.asarray(scan.ranges_m, dtype=np.float64)
    hits = np.isfinite(ranges)
    ends = scan.ends(np.where(hits, ranges, 0.0))[hits]
    ends = ends[:: max(1, -(-len(ends) // MOST_POINTS))]
    return [round(one, 2) for x_m, y_m in ends.tolist() for one in to_map((x_m, y_m), pose)]


AROUND_M = 5.0
"""Metres around a robot without a map, and around its known places, that are shown."""
JPEG_QUALITY = 80
WIDEST_PX = 960
"""Of a wider picture, every second or third pixel is shown."""


class ShownRobot:
    """Offers exactly what the body has.

    `label` is what a name is called in the language now. `moving` tells whether a goal moves it.
    """

    def __init__(
        self,
        body: Body,
        interlock: Interlock,
        guard: Guard,
        label: Label,
        moving: Callable[[], bool] = lambda: False,
    ) -> None:
        self._body = body
        self._label = label
        self._moving = moving
        self._guard = guard
        self._grid = MapGrid()
        permit = partial(guard.velocity, way=Way.CONSOLE_OPERATOR)
        self._steering = (
            Steering(body, interlock, permit) if isinstance(body, TakesVelocity) else None
        )

    def scene(self) -> Mapping[str, Any]:
        """Return the fixed parts, with a new ``version`` for every change."""
        body = self._body
        grid = _received_map(body)
        found: dict[str, Any] = (
            scene_of(body.world, self._label)
            if isinstance(body, InWorld)
            else {"bounds": self._around(grid)}
        )
        if grid:
            found["grid"] = self._grid.as_json(grid)
        found["places"] = [
            {"name": name, "label": self._label(name), "x": x_m, "y": y_m}
            for name, (x_m, y_m) in self._places().items()
        ]
        return {**found, "version": zlib.crc32(repr(found).encode())}

    def live(self) -> Mapping[str, Any]:
        """Return the moving parts."""
        return {**live(self._body, self._label), "moving": self._moving()}

    def picture(self) -> bytes | None:
        """A JPEG of the camera, or of the scene where there is none; None without either."""
        body = self._body
        if isinstance(body, HasCamera):
            pixels = body.camera().pixels
        elif isinstance(body, ReceivesPictures):
            newest = _received(body)
            if newest is None:
                return None
            pixels = newest
        elif isinstance(body, HasPicture) and not isinstance(body, InWorld):
            pixels = body.picture()
        else:
            return None
        from PIL import Image  # which only pictures need

        file = io.BytesIO()
        every = -(-pixels.shape[1] // WIDEST_PX)
        Image.fromarray(np.ascontiguousarray(pixels[::every, ::every])).save(
            file, format="JPEG", quality=JPEG_QUALITY
        )
        return file.getvalue()

    def drive(self, linear_m_s: float, angular_rad_s: float, mark: int | None = None) -> None:
        """Steer it, as interlock and policy permit. Raises `EdgeVoxError`."""
        if self._steering is None:
            raise InvalidValue("drive", self._body.name, "a robot that takes velocities")
        self._steering.steer(linear_m_s, angular_rad_s, mark)

    def halt(self) -> None:
        """End what `drive` began, with one zero."""
        if self._steering:
            self._steering.steer(0.0, 0.0)

    def let_go(self) -> None:
        """Note that the driver has let go of the stick."""
        if self._steering:
            self._steering.let_go()

    @property
    def capabilities(self) -> Mapping[str, Any]:
        """The features that the page may offer."""
        body, names = self._body, {skill.name for skill in self._body.skills}
        pictured = isinstance(body, HasPicture) and not isinstance(body, InWorld)
        return {
            "picture": isinstance(body, HasCamera | ReceivesPictures) or pictured,
            "map": isinstance(body, InWorld | HasPlaces | ReceivesMap),
            "goto": TO_POINT in names,
            "name_place": REMEMBER in names,
            "drive": self._fastest(body) if isinstance(body, TakesVelocity) else False,
        }

    def _fastest(self, body: TakesVelocity) -> dict[str, float]:
        """The highest speeds of which the body is capable and that the policy permits."""
        slowed = self._guard.policy.slowed
        return {
            "linear": slowed(body.max_linear_m_s, 0.0)[0],
            "angular": slowed(0.0, body.max_angular_rad_s)[1],
        }

    def _places(self) -> dict[str, tuple[float, float]]:
        """Return its own places and the remembered ones, but not rooms.

        Rooms are drawn as rooms.
        """
        body = self._body
        found = dict(body.places) if isinstance(body, HasPlaces) else {}
        if isinstance(body, InWorld):
            found = {}
        if isinstance(body, RemembersPlaces):
            memory = body.place_memory
            found |= {
                one.name: (one.x, one.y) for name in memory.names() if (one := memory.find(name))
            }
        return found

    def _around(self, grid: OccupancyMap | None) -> list[float]:
        points = list(self._places().values())
        if grid:
            return _box([*points, *grid.corners()], around_m=0.0)
        pose = live(self._body, self._label).get("pose")
        if isinstance(pose, Mapping) and "x" in pose:
            points.append((round(pose["x"]), round(pose["y"])))
        return _box(points or [(0.0, 0.0)], AROUND_M)


def _box(points: Sequence[Point], around_m: float) -> list[float]:
    """Left, lower, right and upper edge of what holds them all, with so much around it."""
    xs, ys = zip(*points, strict=True)
    edges = min(xs) - around_m, min(ys) - around_m, max(xs) + around_m, max(ys) + around_m
    return [round(edge, 3) for edge in edges]


def _received_map(body: Body) -> OccupancyMap | None:
    newest = body.newest_map() if isinstance(body, ReceivesMap) else None
    return newest if newest and newest.cells.size else None


def _received(body: ReceivesPictures) -> NDArray[np.uint8] | None:
    try:
        return body.newest_picture()
    except InvalidValue as error:
        log.warning("picture_refused", reason=str(error))
        return None
