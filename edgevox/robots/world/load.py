"""The loader of 2D worlds: reads a YAML file in IR-SIM's own format.

EdgeVox's additions, the rooms and the battery, stand where IR-SIM ignores them, under `custom`:

    custom:
      edgevox:
        rooms:
          kitchen: {outline: [[0, 0], [4, 0], [4, 5], [0, 5]], goal: [2, 2], hints: [I am hungry]}
        battery: {capacity_wh: 40}

The first robot is the one that is driven. The edges of the world are solid. IR-SIM's `step_time`,
behaviours, goals and drawing options belong to IR-SIM's own loop and change nothing here.
"""

import math
import random
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import Place, wrong
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.transforms import Pose2D
from edgevox.robots.names import LocalNames, check_told_apart, read_name
from edgevox.robots.shapes import Point, Polygon, distance, inside, place
from edgevox.robots.world.fields import (
    XY,
    Finite,
    WorldPart,
    called,
    check_keys,
    listed,
    within,
    words,
)
from edgevox.robots.world.model import BatterySpec, RobotSpec, Room, Thing, World
from edgevox.robots.world.objects import Area, Entries, Member, members

MOST_ROOMS = 200
TEXTS = listed("a list of texts", 0)
Name = Annotated[str, called(read_name)]


class RoomPart(WorldPart):
    """A room, and the point that it is driven to: the middle, unless it is given."""

    outline: Annotated[tuple[XY, ...], listed("a list of 3 to 1000 [x, y] points", 3, 1000)]
    goal: XY | None = None
    aliases: Annotated[tuple[Name, ...], TEXTS] = ()
    names: LocalNames = Field(default_factory=dict)
    hints: Annotated[tuple[str, ...], TEXTS] = ()

    @model_validator(mode="after")
    def _reaches_its_goal(self) -> Self:
        if not inside(Polygon(self.outline), np.array([self._spot]))[0]:
            raise wrong(("goal",), list(self._spot), "a point inside the outline")
        return self

    @property
    def _spot(self) -> Point:
        x, y = self.goal or np.mean(np.asarray(self.outline), axis=0)
        return float(x), float(y)

    def named(self, name: str) -> Room:
        """The room of this name."""
        return Room(name, Polygon(self.outline), self._spot, self.hints, self.aliases, self.names)


def _few(rooms: dict[str, RoomPart]) -> dict[str, RoomPart]:
    if len(rooms) > MOST_ROOMS:
        raise ValueError(f"at most {MOST_ROOMS} rooms")
    check_told_apart({name: (one.aliases, one.names) for name, one in rooms.items()})
    return rooms


def _battery(data: Any) -> Any:
    if isinstance(data, dict):
        check_keys(data, BatterySpec.__dataclass_fields__)
        return {key: value for key, value in data.items() if value is not None}
    return data


class EdgevoxPart(WorldPart):
    """All of it."""

    rooms: Annotated[dict[Name, RoomPart], AfterValidator(_few)] = Field(default_factory=dict)
    battery: Annotated[BatterySpec, BeforeValidator(_battery)] = BatterySpec()


MOST_THINGS = 2000
_MARGIN_M = 0.5


def _no_map(_map: Any) -> None:
    raise ValueError("no map, only obstacles")


class Extent(WorldPart):
    """The rectangle of the map frame that is the world."""

    is_open: ClassVar[bool] = True
    also: ClassVar[frozenset[str]] = words(
        "name step_time sample_time step_mode control_mode collision_mode gravity friction "
        "restitution drive_tau mdownsample fog_map fog_map_resolution plot status"
    )
    offset: XY = (0.0, 0.0)
    width: Annotated[Finite, within(1.0, 500.0)] = 10.0
    height: Annotated[Finite, within(1.0, 500.0)] = 10.0
    obstacle_map: Annotated[None, BeforeValidator(_no_map)] = None

    @property
    def area(self) -> Area:
        """The area in which randomly placed things stand."""
        x, y = self.offset
        return (
            Pose2D(x + _MARGIN_M, y + _MARGIN_M, -math.pi),
            Pose2D(x + self.width - _MARGIN_M, y + self.height - _MARGIN_M, math.pi),
        )


class Custom(WorldPart):
    """The part of the file that IR-SIM leaves to other programs."""

    is_open: ClassVar[bool] = True
    edgevox: EdgevoxPart = EdgevoxPart()


class WorldFile(WorldPart):
    """A whole file."""

    world: Extent = Extent()
    robot: Entries = ()
    obstacle: Entries = ()
    gui: Any = None
    custom: Custom = Custom()


def apartment_file() -> Path:
    """The world file that EdgeVox brings along: four rooms on 10 x 10 m."""
    return Path(str(resources.files("edgevox.robots").joinpath("worlds/apartment.yaml")))


def load_world(path: Path | None = None, *, seed: int = 0) -> World:
    """Read and check a world file, the apartment without one.

    `seed` decides random parts, such as `distribution: {name: random}`. Raises `InvalidValue`
    naming the file, the field, its value and the expected value.
    """
    return _read(path, seed) if path else _apartment(seed)


def _read(file: Path, seed: int) -> World:
    return parse_world(read_text(file, "world"), file.name, seed=seed)


@lru_cache(maxsize=4)
def _apartment(seed: int) -> World:
    """Read once: it is brought along, so that nobody writes to it while the robot runs."""
    return _read(apartment_file(), seed)


def parse_world(text: str, name: str, *, seed: int = 0) -> World:
    """The world that this YAML text describes; `name` is the file's name in messages."""
    file = YamlFile(text, name)
    under: Place = ()
    if isinstance(file.data, dict) and isinstance(file.data.get("irsim"), dict):
        under = ("irsim",)
    whole = file.read(WorldFile, file.data["irsim"] if under else file.data, under)
    whole.world.warn_of_others(file, (*under, "world"))
    whole.custom.warn_of_others(file, (*under, "custom"))
    dice = random.Random(seed)  # noqa: S311 - the same file and seed are the same world
    robot, things = _objects(file, whole, under, dice)
    ours, (x, y) = whole.custom.edgevox, whole.world.offset
    world = World(
        name=name.partition(".")[0],
        x_min_m=x,
        y_min_m=y,
        width_m=whole.world.width,
        height_m=whole.world.height,
        robot=robot,
        things=things,
        rooms=tuple(room.named(called) for called, room in ours.rooms.items()),
        battery=ours.battery,
    )
    _check_start(world, file, (*under, "robot", 0, "state"))
    return world


def _objects(
    file: YamlFile, whole: WorldFile, under: Place, dice: random.Random
) -> tuple[RobotSpec, tuple[Thing, ...]]:
    def read(key: str, entries: Entries) -> list[Member]:
        found: list[Member] = []
        for index, entry in enumerate(entries):
            at = (*under, key, index)
            entry.warn_of_others(file, at)
            found += members(file, entry, at, whole.world.area, dice)
            if len(found) > MOST_THINGS:
                break
        return found

    robots = read("robot", whole.robot)
    if not robots:
        raise file.wrong((*under, "robot"), None, "at least one robot")
    robot = robots[0].robot(dice)
    others = read("obstacle", whole.obstacle)
    if len(robots) + len(others) > MOST_THINGS:
        expected = f"at most {MOST_THINGS} objects in all"
        raise file.wrong((*under, "obstacle"), len(others), expected)
    things = [one.thing(dice) for one in (*robots[1:], *others)]
    return robot, tuple(thing for thing in things if thing is not None)


def _check_start(world: World, file: YamlFile, where: Place) -> None:
    start, radius = world.robot.start, world.robot.radius_m
    state = [start.x_m, start.y_m]
    if not world.covers(*state):
        raise file.wrong(where, state, "a point inside the world")
    for thing in world.fixed:
        for part in thing.parts:
            if distance(place(part, thing.pose), np.array([state]))[0] < radius:
                raise file.wrong(where, state, f"a free place; {thing.mentioned} stands there")
