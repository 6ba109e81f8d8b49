"""The `robot` and `obstacle` entries of a world file, as IR-SIM means them.

IR-SIM's `shape` gives their outlines; `state` and `distribution` give the places of an entry's
objects.
"""

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import pymunk.autogeometry
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from edgevox.core.files.validation import Place, wrong
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D, distance_on_floor, to_map
from edgevox.robots import shapes
from edgevox.robots.names import MentionedNames, check_thing
from edgevox.robots.shapes import Circle, Line, Point, Polygon, Shape, area, is_convex, place, reach
from edgevox.robots.world.fields import (
    XY,
    Finite,
    Flag,
    NotNegative,
    Positive,
    Text,
    ThreeOrMore,
    TwoOrMore,
    Whole,
    WorldPart,
    called,
    chosen,
    listed,
    one_or_more,
    within,
    words,
)
from edgevox.robots.world.model import LidarSpec, RobotSpec, Thing

log = get_logger(__name__)


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
"""One pose for all objects, or one each; the last one is for all that are left."""


@dataclass(frozen=True)
class Placing:
    """A placement to make: this many objects, with the written poses, in an area."""

    written: Sequence[Pose2D]
    number: int
    area: Area
    dice: random.Random


class Distribution(WorldPart):
    """The placement of an entry's objects: by default, as written."""

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


MOST_OBJECTS = 1000
"""The most objects of one entry; a larger world is a mistake or an attack."""
_ONE_NUMBER_EACH = frozenset({"mass", "friction", "inertia", "restitution"})


class ObjectEntry(WorldPart):
    """An entry for one or several objects. A list holds each object's value, by its index."""

    is_open: ClassVar[bool] = True
    also: ClassVar[frozenset[str]] = words(
        "shape kinematics velocity goal role color static mass friction inertia restitution "
        "vel_min vel_max acce angle_range behavior group_behavior goal_threshold sensors "
        "arrive_mode description group group_name state_dim vel_dim unobstructed fov "
        "fov_radius name names plot"
    )
    number: Annotated[Whole, within(0, MOST_OBJECTS)] = 1
    distribution: AnyDistribution = Distribution()
    state: Poses = (Pose2D(1.0, 1.0, 0.0),)


Entries = Annotated[tuple[ObjectEntry, ...], BeforeValidator(one_or_more)]


def members(
    file: YamlFile, entry: ObjectEntry, place: Place, area: Area, dice: random.Random
) -> Iterator["Member"]:
    """The single objects of an entry."""
    try:
        poses = entry.distribution.poses(Placing(entry.state, entry.number, area, dice))
    except ValidationError as error:
        raise file.explain(error, place) from None
    for index, pose in enumerate(poses):
        data = {key: _nth(key, value, index) for key, value in (entry.model_extra or {}).items()}
        yield Member(file, place, pose, {key: one for key, one in data.items() if one is not None})


@dataclass(frozen=True)
class Member:
    """An object: its part of the file, and its pose."""

    file: YamlFile
    place: Place
    pose: Pose2D
    data: dict[str, Any]

    def robot(self, dice: random.Random) -> RobotSpec:
        """The robot that is driven. Its shape counts as the circle around it."""
        part = self.file.read(_RobotEntry, self.data, self.place)
        if part.kinematics.name != "diff":
            field, expected = ("kinematics", "name"), "'diff', a robot with two driven wheels"
            raise self.file.wrong((*self.place, *field), part.kinematics.name or "none", expected)
        self._refuse_names("nothing: no sentence mentions the robot that is driven")
        linear, angular = part.vel_max
        linear_acceleration, angular_acceleration = part.acce
        return RobotSpec(
            radius_m=reach(self._parts(part.shape, dice)),
            start=self.pose,
            max_linear_m_s=linear or 1.0,
            max_angular_rad_s=angular or 1.0,
            max_linear_m_s2=linear_acceleration or 2.0,
            max_angular_rad_s2=angular_acceleration or 6.0,
            mass_kg=part.mass,
            lidar=self._lidar(part.sensors),
        )

    def thing(self, dice: random.Random) -> Thing | None:
        """A wall or a piece of furniture; None for one that nothing touches (`unobstructed`).

        What would move by itself in IR-SIM stands still here, and can be pushed.
        """
        if self.data.get("unobstructed") is True:
            self._refuse_names("nothing: no sentence mentions what is in nobody's way")
            return None
        part = self.file.read(_ThingEntry, self.data, self.place)
        parts = self._parts(part.shape, dice)
        if math.isfinite(part.mass_kg):
            if any(isinstance(one, Line) for one in parts):
                expected = "no mass: a line cannot be pushed"
                raise self.file.wrong((*self.place, "mass"), part.mass_kg, expected)
            parts = tuple(hull(one) if isinstance(one, Polygon) else one for one in parts)
        return Thing(
            name=part.name or ("wall" if isinstance(parts[0], Line) else "obstacle"),
            parts=parts,
            pose=self.pose,
            mass_kg=part.mass_kg,
            friction=part.friction,
            color=part.color if isinstance(part.color, str) else None,
            names=part.names,
        )

    def _refuse_names(self, expected: str) -> None:
        if self.data.get("names"):
            raise self.file.wrong((*self.place, "names"), self.data["names"], expected)

    def _parts(self, shape: ShapePart | None, dice: random.Random) -> tuple[Shape, ...]:
        if shape is None:
            where = self.file.field((*self.place, "shape"))
            log.warning("world_shape_absent", where=where, taken="a circle of 1 m")
            return (Circle((0.0, 0.0), 1.0),)
        return shape.made(dice)

    def _lidar(self, sensors: tuple[dict[str, Any], ...]) -> LidarSpec:
        for index, sensor in enumerate(sensors):
            place = (*self.place, "sensors", index)
            if "lidar2d" not in (sensor.get("name"), sensor.get("type")):
                log.warning("world_sensor_ignored", where=self.file.field(place))
                continue
            part = self.file.read(_LidarEntry, sensor, place)
            part.warn_of_others(self.file, place)
            if part.noise:
                log.warning("world_noise_ignored", where=self.file.field((*place, "noise")))
            return part.spec
        return LidarSpec()


class _DriveKinematics(BaseModel):
    name: Text = ""


Limit = Annotated[
    Annotated[Finite, within(0.01, 100.0)] | None,
    BeforeValidator(lambda value: None if value == math.inf else value),
]
Limits = Annotated[
    tuple[Limit, Limit],
    BeforeValidator(lambda value: value[:2]),
    listed("two numbers [forward, turning]", 2),
]


class _RobotEntry(BaseModel):
    shape: AnyShape | None = None
    kinematics: _DriveKinematics = _DriveKinematics()
    vel_max: Limits = (None, None)
    acce: Limits = (None, None)
    mass: Positive = 20.0
    sensors: Annotated[tuple[dict[str, Any], ...], BeforeValidator(one_or_more)] = ()


def _weighs(mass: float, info: ValidationInfo) -> float:
    if info.data.get("static"):
        return math.inf
    if mass != math.inf and not 1e-3 <= mass <= 1e5:
        raise ValueError(f"a number from {1e-3:g} to {1e5:g}")
    return mass


class _ThingEntry(BaseModel):
    shape: AnyShape | None = None
    kinematics: _DriveKinematics = _DriveKinematics()
    unobstructed: Flag = False
    static: Flag = False
    mass: Annotated[float, Field(strict=True), AfterValidator(_weighs)] | None = None
    name: Annotated[Text, called(check_thing)] | None = None
    names: MentionedNames = Field(default_factory=dict)
    friction: Annotated[Finite, within(0.0, 10.0)] = 0.5
    color: Any = None

    @property
    def mass_kg(self) -> float:
        """The mass.

        A driven object has 1 kg, another stands fast, unless the file says otherwise.
        """
        if self.mass is not None:
            return self.mass
        drives = self.kinematics.name not in ("", "static") and not self.static
        return 1.0 if drives else math.inf


class _LidarEntry(WorldPart):
    is_open: ClassVar[bool] = True
    also: ClassVar[frozenset[str]] = words(
        "name type scan_time std angle_std alpha has_velocity color"
    )
    number: Annotated[Whole, within(1, 10_000)] = 100
    angle_range: Positive = math.pi
    range_min: Annotated[Finite, within(0.0, 1000.0)] = 0.0
    range_max: Finite = 10.0
    offset: ThreeOrMore = (0.0, 0.0, 0.0)
    noise: Flag = False

    @field_validator("range_max")
    @classmethod
    def _beyond_the_nearest(cls, furthest: float, info: ValidationInfo) -> float:
        nearest = max(info.data.get("range_min", 0.0), 0.01)
        if not nearest <= furthest <= 1000.0:
            raise ValueError(f"a number from {nearest:g} to 1000")
        return furthest

    @property
    def spec(self) -> LidarSpec:
        """The lidar's specification on the robot."""
        return LidarSpec(
            beams=self.number,
            angle_range_rad=min(self.angle_range, 2 * math.pi),
            range_min_m=self.range_min,
            range_max_m=self.range_max,
            mount=Pose2D(*self.offset[:3]),
        )


def _nth(key: str, value: Any, index: int) -> Any:
    """Return the value for the object with this index, as IR-SIM does.

    Its own, or the shared one.
    """
    if key == "sensors" or not isinstance(value, list) or not value:
        return value
    shared = all(isinstance(v, int | float) for v in value) and key not in _ONE_NUMBER_EACH
    return value if shared else value[min(index, len(value) - 1)]
