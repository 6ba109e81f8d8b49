"""A 2D world as an image: rooms, walls, furniture, what the lidar sees, where the robot drove.

Needs Pillow; nothing that runs a robot imports it.
"""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import LidarScan
from edgevox.robots.picture_sheet import Color, Sheet
from edgevox.robots.shapes import Line, Point, Polygon, Shape, place
from edgevox.robots.world_model import World

SMOOTHING = 3
"""Everything is drawn this much larger and shrunk at the end: smooth edges."""
_FLOORS: tuple[Color, ...] = (
    (253, 246, 231, 255),
    (240, 242, 252, 255),
    (238, 247, 238, 255),
    (251, 239, 238, 255),
)
_WALL: Color = (52, 60, 76, 255)
_LIDAR: Color = (58, 134, 255, 34)


def picture(
    world: World,
    robot: Pose2D,
    movable: Sequence[Pose2D],
    *,
    trail: Sequence[Point] = (),
    scan: LidarScan | None = None,
    width_px: int = 1200,
) -> Image.Image:
    """The world from above, y up. `trail` is drawn from orange (oldest) to red (newest)."""
    painter = Painter(world, width_px, avoid=[Line(tuple(trail))] if len(trail) > 1 else ())
    return painter.paint(robot, movable, trail=trail, scan=scan)


class Painter:
    """Draws one world again and again: what never changes is drawn and thought out once."""

    def __init__(
        self,
        world: World,
        width_px: int,
        *,
        smoothing: int = SMOOTHING,
        avoid: Sequence[Shape] = (),
    ) -> None:
        """Room names cover none of `avoid`."""
        self._world, self._smoothing = world, smoothing
        self._floor = Sheet(world, width_px * smoothing)
        for room, color in zip(world.rooms, _FLOORS * len(world.rooms), strict=False):
            self._floor.area(room.outline, color)
        self._floor.grid()
        self._floor.scale()
        for thing in world.fixed:
            if not thing.is_wall:
                self._floor.furniture(thing, thing.pose)
        for thing in world.fixed:
            if thing.is_wall:
                for part in thing.parts:
                    self._floor.area(place(part, thing.pose), _WALL)
        taken = [place(part, t.pose) for t in world.things for part in t.parts]
        for room in world.rooms:
            self._floor.label(room, [*taken, *avoid])

    def paint(
        self,
        robot: Pose2D,
        movable: Sequence[Pose2D],
        *,
        trail: Sequence[Point] = (),
        scan: LidarScan | None = None,
    ) -> Image.Image:
        """The world as it is now; see `picture`."""
        world, sheet = self._world, self._floor.copy()
        if scan is not None:
            sheet.area(Polygon(seen(scan, robot)), _LIDAR)
        for thing, pose in zip(world.movable, movable, strict=True):
            sheet.furniture(thing, pose)
        sheet.trail(trail)
        sheet.robot(robot, world.robot.radius_m)
        return sheet.finished(self._smoothing)


def seen(scan: LidarScan, robot: Pose2D) -> tuple[Point, ...]:
    """The corners of the area that a sweep found free, map frame."""
    ends = scan.ends(np.minimum(scan.ranges_m, scan.range_max_m))
    return tuple(to_map((x, y), robot) for x, y in ends.tolist())
