"""The model of a 2D world: the robot, the things, the rooms."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from edgevox.agent.skills.skill import OwnName
from edgevox.core.reason import Named
from edgevox.core.transforms import ORIGIN, Pose2D
from edgevox.robots.limits import Bounds
from edgevox.robots.shapes import Floats, Point, Polygon, Shape, inside
from edgevox.robots.world.fields import XY, NotNegative, Positive


@dataclass(frozen=True, slots=True)
class LidarSpec:
    """A 2D lidar."""

    beams: int = 360
    angle_range_rad: float = 2 * math.pi
    """Centred on its forward direction. A full circle starts at -pi and does not repeat its
    first beam; a part of one includes both ends."""
    range_min_m: float = 0.0
    range_max_m: float = 10.0
    mount: Pose2D = ORIGIN
    """Its pose on the robot."""

    @property
    def increment_rad(self) -> float:
        """Angle between two beams."""
        whole = self.angle_range_rad > 2 * math.pi * (1 - 0.5 / self.beams)
        return self.angle_range_rad / (self.beams if whole else max(self.beams - 1, 1))


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """A round robot on two driven wheels: size, limits, where it starts."""

    radius_m: float
    start: Pose2D
    max_linear_m_s: float = 1.0
    max_angular_rad_s: float = 1.0
    max_linear_m_s2: float = 2.0
    max_angular_rad_s2: float = 6.0
    mass_kg: float = 20.0
    lidar: LidarSpec = field(default_factory=LidarSpec)


@dataclass(frozen=True, slots=True)
class Thing:
    """A wall or a piece of furniture."""

    name: str
    parts: tuple[Shape, ...]
    """Shapes in the thing's own frame."""
    pose: Pose2D
    """The pose of that frame, map frame."""
    mass_kg: float = math.inf
    """A finite mass lets the robot push it."""
    friction: float = 0.5
    """The floor's."""
    color: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    """Its name by language."""

    @property
    def movable(self) -> bool:
        return math.isfinite(self.mass_kg)

    @property
    def is_wall(self) -> bool:
        """Whether its name says that it is part of the building."""
        return self.name.startswith("wall")

    @property
    def spoken(self) -> str:
        """Its name in a person's words: `chair_2` is a chair, `wall_north` is a wall."""
        if self.is_wall:
            return "wall"
        return self.name.replace("_", " ").rstrip("0123456789 ") or "thing"

    @property
    def mentioned(self) -> str:
        """The spoken name with its article: an office chair."""
        return f"{'an' if self.spoken[0].lower() in 'aeiou' else 'a'} {self.spoken}"

    @property
    def named(self) -> Named:
        """Its form in sentences, by language."""
        return Named(self.mentioned, self.names)


@dataclass(frozen=True, slots=True)
class Room:
    """A named area."""

    name: str
    outline: Polygon
    goal: Point
    """The point that "go there" means."""
    hints: tuple[str, ...] = ()
    """Sentences of people who want to be there."""
    aliases: tuple[str, ...] = ()
    """Other words for it."""
    names: Mapping[str, OwnName] = field(default_factory=dict)
    """Its name by language."""

    @property
    def spoken(self) -> str:
        """The name as a person says it: `living_room` is the living room."""
        return self.name.replace("_", " ")


@dataclass(frozen=True, slots=True)
class BatterySpec:
    """The consumption of a battery (see `Battery`), and the place where it is charged."""

    capacity_wh: Positive = 40.0
    idle_w: NotNegative = 1.0
    linear_w_per_m_s: NotNegative = 25.0
    angular_w_per_rad_s: NotNegative = 4.0
    charge_w: NotNegative = 60.0
    dock: XY | None = None


@dataclass(frozen=True, slots=True)
class World:
    """A rectangle of the map frame with solid edges and everything that stands in it."""

    name: str
    x_min_m: float
    y_min_m: float
    width_m: float
    height_m: float
    robot: RobotSpec
    things: tuple[Thing, ...] = ()
    rooms: tuple[Room, ...] = ()
    battery: BatterySpec = field(default_factory=BatterySpec)

    @property
    def x_max_m(self) -> float:
        return self.x_min_m + self.width_m

    @property
    def y_max_m(self) -> float:
        return self.y_min_m + self.height_m

    @property
    def fixed(self) -> tuple[Thing, ...]:
        """The things that stay where they are."""
        return tuple(t for t in self.things if not t.movable)

    @property
    def movable(self) -> tuple[Thing, ...]:
        """The things that can be pushed."""
        return tuple(t for t in self.things if t.movable)

    @property
    def border(self) -> Floats:
        """The world's edges as segments, (4, 4)."""
        x0, y0, x1, y1 = self.x_min_m, self.y_min_m, self.x_max_m, self.y_max_m
        return np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])

    @property
    def bounds(self) -> Bounds:
        """The world's edges."""
        return Bounds(self.name, self.x_min_m, self.x_max_m, self.y_min_m, self.y_max_m)

    def covers(self, x_m: float, y_m: float) -> bool:
        """Return whether a point is within the edges."""
        return self.x_min_m <= x_m <= self.x_max_m and self.y_min_m <= y_m <= self.y_max_m

    def room_at(self, x_m: float, y_m: float) -> Room | None:
        """The first room whose outline covers a point."""
        point = np.array([[x_m, y_m]])
        return next((r for r in self.rooms if inside(r.outline, point)[0]), None)
