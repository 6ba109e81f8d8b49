"""Loads a 2D world from a YAML file in IR-SIM's own format.

What EdgeVox needs beyond IR-SIM stands where IR-SIM ignores it, under `custom`:

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
from collections.abc import Iterator
from importlib import resources
from itertools import islice
from pathlib import Path

import numpy as np

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.core.user_file import read_text
from edgevox.core.yaml_file import parse_yaml
from edgevox.robots.shapes import distance, place
from edgevox.robots.world_fields import Fields, as_point, words
from edgevox.robots.world_model import RobotSpec, Thing, World
from edgevox.robots.world_objects import members, read_robot, read_thing
from edgevox.robots.world_rooms import read_battery, read_rooms

MOST_THINGS = 2000
_MARGIN_M = 0.5
_TOP_KEYS = ("world", "robot", "obstacle", "gui", "custom")
_WORLD_KEYS = words(
    "name height width step_time sample_time offset step_mode control_mode collision_mode gravity "
    "friction restitution drive_tau obstacle_map mdownsample fog_map fog_map_resolution plot "
    "status"
)


def apartment_file() -> Path:
    """The world file that EdgeVox brings along: four rooms on 10 x 10 m."""
    return Path(str(resources.files("edgevox.robots").joinpath("worlds/apartment.yaml")))


def load_world(path: Path | None = None, *, seed: int = 0) -> World:
    """Read and check a world file, the apartment without one.

    What the file leaves to chance, such as `distribution: {name: random}`, comes from `seed`.
    Raises `InvalidValue` naming the file, the field, its value and what was expected.
    """
    file = path or apartment_file()
    return parse_world(read_text(file, "world"), file.name, seed=seed)


def parse_world(text: str, name: str, *, seed: int = 0) -> World:
    """The world that this YAML text describes; `name` is the file's name in messages."""
    top = Fields(name, parse_yaml(text, name))
    if isinstance(top.get("irsim"), dict):
        top = top.sub("irsim")
    top.check_keys(_TOP_KEYS)
    settings = top.sub("world")
    settings.check_keys(_WORLD_KEYS, others=True)
    if "obstacle_map" in settings:
        raise InvalidValue(
            settings.path("obstacle_map"), settings.get("obstacle_map"), "no map, only obstacles"
        )
    custom = top.sub("custom")
    custom.check_keys(["edgevox"], others=True)
    ours = custom.sub("edgevox")
    ours.check_keys(["rooms", "battery"])
    x, y, width, height = _extent(settings)
    dice = random.Random(seed)  # noqa: S311 - the same file and seed are the same world
    robot, things = _objects(top, (x, y, width, height), dice)
    world = World(
        name=name.partition(".")[0],
        x_min_m=x,
        y_min_m=y,
        width_m=width,
        height_m=height,
        robot=robot,
        things=things,
        rooms=read_rooms(ours.sub("rooms")),
        battery=read_battery(ours.sub("battery")),
    )
    _check_start(world, top.path("robot"))
    return world


def _extent(settings: Fields) -> tuple[float, float, float, float]:
    x, y = 0.0, 0.0
    if "offset" in settings:
        x, y = as_point(settings.path("offset"), settings.get("offset"))
    width = settings.number("width", 10.0, low=1.0, high=500.0)
    return x, y, width, settings.number("height", 10.0, low=1.0, high=500.0)


def _objects(
    top: Fields, extent: tuple[float, float, float, float], dice: random.Random
) -> tuple[RobotSpec, tuple[Thing, ...]]:
    x, y, width, height = extent
    area = (
        Pose2D(x + _MARGIN_M, y + _MARGIN_M, -math.pi),
        Pose2D(x + width - _MARGIN_M, y + height - _MARGIN_M, math.pi),
    )
    robots = _most(one for group in top.each("robot") for one in members(group, area, dice))
    if not robots:
        raise InvalidValue(top.path("robot"), top.get("robot"), "at least one robot")
    robot = read_robot(robots[0], dice)
    others = _most(one for group in top.each("obstacle") for one in members(group, area, dice))
    if len(robots) + len(others) > MOST_THINGS:
        raise InvalidValue(
            top.path("obstacle"), len(others), f"at most {MOST_THINGS} objects in all"
        )
    things = [read_thing(one, dice) for one in (*robots[1:], *others)]
    return robot, tuple(thing for thing in things if thing is not None)


def _most(objects: Iterator[Fields]) -> list[Fields]:
    return list(islice(objects, MOST_THINGS + 1))


def _check_start(world: World, where: str) -> None:
    start, radius = world.robot.start, world.robot.radius_m
    state = [start.x_m, start.y_m]
    if not world.covers(*state):
        raise InvalidValue(f"{where}.state", state, "a point inside the world")
    for thing in world.fixed:
        for part in thing.parts:
            if distance(place(part, thing.pose), np.array([state]))[0] < radius:
                raise InvalidValue(
                    f"{where}.state", state, f"a free place; {thing.mentioned} stands there"
                )
