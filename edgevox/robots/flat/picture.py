"""A 2D world as an image: rooms, walls, furniture, the lidar's points, the robot's path.

`Sheet` is the paper that the world is drawn on, in metres. Needs Pillow; no module that runs a
robot imports it.
"""

import math
from collections.abc import Sequence
from copy import copy
from itertools import pairwise

import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont

from edgevox.core.transforms import Pose2D, to_map
from edgevox.robots.capabilities import LidarScan
from edgevox.robots.shapes import (
    Circle,
    Line,
    Point,
    Polygon,
    Shape,
    bounds,
    distance,
    inside,
    place,
)
from edgevox.robots.world.model import Room, Thing, World

Color = tuple[int, int, int, int]

_MARGIN_M = 0.35
_PAPER: Color = (255, 255, 255, 255)
_GRID: Color = (40, 50, 70, 16)
_SHADOW: Color = (30, 36, 48, 38)
_TEXT: Color = (84, 92, 110, 255)
_TRAIL_FROM: Color = (255, 170, 60, 255)
_TRAIL_TO: Color = (226, 40, 96, 255)
_ROBOT: Color = (37, 99, 235, 255)
_LIGHT: Color = (255, 255, 255, 255)
_LARGE_M, _SMALL_M = 0.36, 0.15
"""Heights of letters."""


class Sheet:
    """Paper that is drawn on in metres."""

    def __init__(self, world: World, width_px: int) -> None:
        self._world = world
        self._scale = width_px / (world.width_m + 2 * _MARGIN_M)
        height_px = round((world.height_m + 2 * _MARGIN_M) * self._scale)
        self._image = Image.new("RGBA", (width_px, height_px), _PAPER)

    def copy(self) -> "Sheet":
        """Another one with the same on it."""
        other = copy(self)
        other._image = self._image.copy()  # noqa: SLF001 - the same class
        return other

    def area(self, shape: Shape, fill: Color, edge: Color | None = None) -> None:
        if fill[3] == 255:
            self._draw(ImageDraw.Draw(self._image), shape, fill, edge)
            return
        left, top, right, bottom = self._box(shape)
        layer = Image.new("RGBA", (right - left, bottom - top), (0, 0, 0, 0))
        self._draw(ImageDraw.Draw(layer), shape, fill, edge, (left, top))
        self._image.alpha_composite(layer, (left, top))

    def _draw(
        self,
        pen: ImageDraw.ImageDraw,
        shape: Shape,
        fill: Color,
        edge: Color | None,
        corner: tuple[int, int] = (0, 0),
    ) -> None:
        """Draw on paper whose upper left pixel is `corner` of the whole sheet."""
        width = self._pen_px
        match shape:
            case Circle((x, y), r):
                corners = [self._px((x - r, y + r), corner), self._px((x + r, y - r), corner)]
                pen.ellipse(corners, fill=fill, outline=edge, width=width if edge else 0)
            case Polygon(vertices):
                points = [self._px(v, corner) for v in vertices]
                pen.polygon(points, fill, edge, width if edge else 0)
            case Line(vertices):
                pen.line([self._px(v, corner) for v in vertices], fill, width, joint="curve")

    @property
    def _pen_px(self) -> int:
        return max(1, round(0.02 * self._scale))

    def _box(self, shape: Shape) -> tuple[int, int, int, int]:
        """The pixels that a shape and its edge can cover: left, top, right, bottom."""
        x0, y0, x1, y1 = bounds(shape)
        left, top = self._px((x0, y1))
        right, bottom = self._px((x1, y0))
        more, (width, height) = self._pen_px + 1, self._image.size
        return (
            min(max(math.floor(left) - more, 0), width - 1),
            min(max(math.floor(top) - more, 0), height - 1),
            min(max(math.ceil(right) + more, 1), width),
            min(max(math.ceil(bottom) + more, 1), height),
        )

    def furniture(self, thing: Thing, pose: Pose2D) -> None:
        """A body with a shadow; what can be pushed casts the longer one."""
        lift = 0.07 if thing.movable else 0.03
        color = _color(thing)
        edge = _mixed(color, (0, 0, 0, 255), 0.35)
        low = Pose2D(pose.x_m + lift, pose.y_m - lift, pose.yaw_rad)
        for part in thing.parts:
            self.area(place(part, low), _SHADOW)
        for part in thing.parts:
            self.area(place(part, pose), color, edge)
        x0, y0, x1, y1 = bounds(place(thing.parts[0], pose))
        middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        wide, high = self._size(thing.spoken, _SMALL_M)
        covered = inside(place(thing.parts[0], pose), np.array([middle]))[0]
        if covered and wide < x1 - x0 - 0.05 and high < y1 - y0:
            self.text(middle, thing.spoken, _SMALL_M, edge)

    def grid(self) -> None:
        """Faint lines, a metre apart."""
        world = self._world
        for x in range(round(world.width_m) + 1):
            at = world.x_min_m + x
            self.area(Line(((at, world.y_min_m), (at, world.y_max_m))), _GRID)
        for y in range(round(world.height_m) + 1):
            at = world.y_min_m + y
            self.area(Line(((world.x_min_m, at), (world.x_max_m, at))), _GRID)

    def trail(self, points: Sequence[Point]) -> None:
        pen = ImageDraw.Draw(self._image)
        width = round(0.055 * self._scale)
        for number, (a, b) in enumerate(pairwise(points)):
            color = _mixed(_TRAIL_FROM, _TRAIL_TO, number / len(points))
            pen.line([self._px(a), self._px(b)], color, width)
            x, y = self._px(b)
            pen.ellipse([x - width / 2, y - width / 2, x + width / 2, y + width / 2], color)
        if points:
            self.area(Circle(points[0], 0.11), _LIGHT, _TRAIL_FROM)

    def robot(self, pose: Pose2D, radius_m: float) -> None:
        here = (pose.x_m, pose.y_m)
        self.area(Circle((here[0] + 0.04, here[1] - 0.04), radius_m), _SHADOW)
        self.area(Circle(here, radius_m), _ROBOT, _LIGHT)
        tip, back, side = 0.68 * radius_m, 0.3 * radius_m, 0.48 * radius_m
        arrow = Polygon(((tip, 0.0), (-back * 1.4, side), (-back * 0.6, 0.0), (-back * 1.4, -side)))
        self.area(place(arrow, pose), _LIGHT)

    def scale(self) -> None:
        """A bar of one metre, below the lower left corner."""
        x, y = self._world.x_min_m, self._world.y_min_m - 0.17
        for a, b in (
            ((x, y), (x + 1, y)),
            ((x, y - 0.05), (x, y + 0.05)),
            ((x + 1, y - 0.05), (x + 1, y + 0.05)),
        ):
            self.area(Line((a, b)), _TEXT)
        self.text((x + 1.25, y), "1 m", 0.2, _TEXT)

    def label(self, room: Room, taken: Sequence[Shape]) -> None:
        """The room's name, as near to its middle as it covers nothing."""
        x0, y0, x1, y1 = bounds(room.outline)
        wide, high = self._size(room.spoken, _LARGE_M)
        middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2])
        across, up = np.meshgrid(
            np.arange(x0 + wide / 2 + 0.3, x1 - wide / 2 - 0.2, 0.1),
            np.arange(y0 + high / 2 + 0.3, y1 - high / 2 - 0.2, 0.1),
        )
        spots = np.stack([across.ravel(), up.ravel()], axis=1)
        room_left = np.full(len(spots), np.inf)
        for dx in np.linspace(-wide / 2, wide / 2, 7):
            for shape in taken:
                room_left = np.minimum(room_left, distance(shape, spots + np.array([dx, 0.0])))
        far = np.hypot(*(spots - middle).T) + 10.0 * (room_left < high)
        best = spots[far.argmin()] if len(spots) else middle
        self.text((float(best[0]), float(best[1])), room.spoken, _LARGE_M, _TEXT)

    def text(self, point: Point, words: str, height_m: float, color: Color) -> None:
        font = ImageFont.load_default(height_m * self._scale)
        pen = ImageDraw.Draw(self._image)
        pen.text(self._px(point), words, color, font, anchor="mm")

    def _size(self, words: str, height_m: float) -> tuple[float, float]:
        font = ImageFont.load_default(height_m * self._scale)
        left, top, right, bottom = font.getbbox(words)
        return (right - left) / self._scale, (bottom - top) / self._scale

    def finished(self, smoothing: int) -> Image.Image:
        """The picture, this many times smaller."""
        return self._image.convert("RGB").reduce(smoothing)

    def _px(self, point: Point, corner: tuple[int, int] = (0, 0)) -> tuple[float, float]:
        x = (point[0] - self._world.x_min_m + _MARGIN_M) * self._scale
        y = (self._world.y_max_m - point[1] + _MARGIN_M) * self._scale
        return x - corner[0], y - corner[1]


def _color(thing: Thing) -> Color:
    """The colour that the world file names, softened; grey for one that Pillow does not know."""
    try:
        red, green, blue = ImageColor.getrgb(thing.color or "silver")[:3]
    except ValueError:
        red, green, blue = 192, 192, 192
    return _mixed((red, green, blue, 255), (255, 255, 255, 255), 0.25)


def _mixed(one: Color, other: Color, part: float) -> Color:
    red, green, blue, alpha = (round(a + part * (b - a)) for a, b in zip(one, other, strict=True))
    return red, green, blue, alpha


SMOOTHING = 3
"""The factor by which a picture is drawn larger and then shrunk, for smooth edges."""
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
