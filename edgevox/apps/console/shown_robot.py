"""A body as the console's page sees and steers it, whatever body it is."""

import io
import zlib
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.going import TO_POINT
from edgevox.agent.policy import Guard
from edgevox.apps.console.live_view import live
from edgevox.apps.console.map_grid import MapGrid
from edgevox.apps.console.map_scene import InWorld, Label, scene_of
from edgevox.core.errors import InvalidValue
from edgevox.core.interlock import Interlock
from edgevox.core.log import get_logger
from edgevox.core.ways import Way
from edgevox.robots.capabilities import (
    Body,
    HasCamera,
    HasPicture,
    HasPlaces,
    ReceivesMap,
    ReceivesPictures,
    RemembersPlaces,
    TakesVelocity,
)
from edgevox.robots.occupancy_map import OccupancyMap
from edgevox.robots.places.skills import REMEMBER
from edgevox.robots.shapes import Point
from edgevox.robots.velocity_steering import Steering

log = get_logger(__name__)

AROUND_M = 5.0
"""Of a robot without a map so much is shown around where it is and the places that it knows."""
JPEG_QUALITY = 80
WIDEST_PX = 960
"""Of a wider picture every second pixel is shown, or every third."""


class ShownRobot:
    """Offers exactly what the body has. `label` is what a name is called in the language now."""

    def __init__(self, body: Body, interlock: Interlock, guard: Guard, label: Label) -> None:
        self._body = body
        self._label = label
        self._grid = MapGrid()
        permit = partial(guard.velocity, way=Way.CONSOLE_OPERATOR)
        self._steering = (
            Steering(body, interlock, permit) if isinstance(body, TakesVelocity) else None
        )

    def scene(self) -> Mapping[str, Any]:
        """What does not move; another ``version`` whenever it is another."""
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
        """What moves."""
        return live(self._body, self._label)

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
        """Whoever steered has let go of the stick."""
        if self._steering:
            self._steering.let_go()

    @property
    def capabilities(self) -> Mapping[str, Any]:
        """What the page may offer."""
        body, names = self._body, {skill.name for skill in self._body.skills}
        drive = isinstance(body, TakesVelocity)
        pictured = isinstance(body, HasPicture) and not isinstance(body, InWorld)
        return {
            "picture": isinstance(body, HasCamera | ReceivesPictures) or pictured,
            "map": isinstance(body, InWorld | HasPlaces | ReceivesMap),
            "goto": TO_POINT in names,
            "name_place": REMEMBER in names,
            "drive": {"linear": body.max_linear_m_s, "angular": body.max_angular_rad_s}
            if drive and isinstance(body, TakesVelocity)
            else False,
        }

    def _places(self) -> dict[str, tuple[float, float]]:
        """Those that it knows by itself, and what it was told to remember; not rooms, which are
        drawn as such.
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
