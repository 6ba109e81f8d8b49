"""Reads the `robot` and `obstacle` entries of a world file, as IR-SIM means them."""

import math
import random
from collections.abc import Iterator
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.names import check_thing
from edgevox.robots.shapes import Line, Polygon, Shape, reach
from edgevox.robots.world_fields import Fields, as_number, as_numbers, words
from edgevox.robots.world_model import LidarSpec, RobotSpec, Thing
from edgevox.robots.world_places import poses
from edgevox.robots.world_shapes import hull, read_shape

log = get_logger(__name__)

MOST_OBJECTS = 1000
"""Of one entry; a world of more is a mistake or an attack."""

OBJECT_KEYS = words(
    "shape kinematics state velocity goal role color static mass friction inertia restitution "
    "vel_min vel_max acce angle_range behavior group_behavior goal_threshold sensors arrive_mode "
    "description group group_name state_dim vel_dim unobstructed fov fov_radius name plot number "
    "distribution"
)
_ONE_NUMBER_EACH = frozenset({"mass", "friction", "inertia", "restitution"})
_LIDAR_KEYS = words(
    "name type range_min range_max angle_range number scan_time noise std angle_std offset alpha "
    "has_velocity color"
)


def members(group: Fields, area: tuple[Pose2D, Pose2D], dice: random.Random) -> Iterator[Fields]:
    """The single objects of an entry with a `number`; each has a `state` of three numbers."""
    group.check_keys(OBJECT_KEYS, others=True)
    number = group.whole("number", 1, low=0, high=MOST_OBJECTS)
    for index, pose in enumerate(poses(group, number, area, dice)):
        data = {key: _nth(key, value, index) for key, value in group.data.items()}
        data["state"] = [pose.x_m, pose.y_m, pose.yaw_rad]
        yield Fields(group.where, data)


def read_robot(fields: Fields, dice: random.Random) -> RobotSpec:
    """The robot that is driven. Its shape counts as the circle around it."""
    kind = fields.sub("kinematics").text("name", "none")
    if kind != "diff":
        raise InvalidValue(
            f"{fields.path('kinematics')}.name", kind, "'diff', a robot with two driven wheels"
        )
    linear, angular = _pair(fields, "vel_max", (1.0, 1.0))
    linear_acceleration, angular_acceleration = _pair(fields, "acce", (2.0, 6.0))
    return RobotSpec(
        radius_m=reach(_parts(fields, dice)),
        start=_pose(fields),
        max_linear_m_s=linear,
        max_angular_rad_s=angular,
        max_linear_m_s2=linear_acceleration,
        max_angular_rad_s2=angular_acceleration,
        mass_kg=fields.positive("mass", 20.0),
        lidar=_lidar(fields),
    )


def read_thing(fields: Fields, dice: random.Random) -> Thing | None:
    """A wall or a piece of furniture; None for one that nothing touches (`unobstructed`).

    What would move by itself in IR-SIM stands still here, and can be pushed.
    """
    if fields.flag("unobstructed"):
        return None
    parts = _parts(fields, dice)
    mass_kg = _mass(fields)
    if math.isfinite(mass_kg):
        if any(isinstance(part, Line) for part in parts):
            raise InvalidValue(fields.path("mass"), mass_kg, "no mass: a line cannot be pushed")
        parts = tuple(hull(p) if isinstance(p, Polygon) else p for p in parts)
    color = fields.get("color")
    return Thing(
        name=check_thing(
            fields.path("name"),
            fields.text("name", "wall" if isinstance(parts[0], Line) else "obstacle"),
        ),
        parts=parts,
        pose=_pose(fields),
        mass_kg=mass_kg,
        friction=fields.number("friction", 0.5, low=0.0, high=10.0),
        color=color if isinstance(color, str) else None,
    )


def _nth(key: str, value: Any, index: int) -> Any:
    """What IR-SIM gives the object with this index: its entry of a list, or what all share."""
    if key == "sensors" or not isinstance(value, list) or not value:
        return value
    shared = all(isinstance(v, int | float) for v in value) and key not in _ONE_NUMBER_EACH
    return value if shared else value[min(index, len(value) - 1)]


def _pose(fields: Fields) -> Pose2D:
    return Pose2D(*fields.get("state"))


def _parts(fields: Fields, dice: random.Random) -> tuple[Shape, ...]:
    if "shape" not in fields:
        log.warning("world_shape_absent", where=fields.path("shape"), taken="a circle of 1 m")
        return read_shape(Fields(fields.path("shape"), {"radius": 1.0}), dice)
    return read_shape(fields.sub("shape"), dice)


def _mass(fields: Fields) -> float:
    if fields.flag("static"):
        return math.inf
    value = fields.get("mass")
    if value is None:
        drives = fields.sub("kinematics").text("name", "static") != "static"
        return 1.0 if drives else math.inf
    return math.inf if value == math.inf else as_number(fields.path("mass"), value, 1e-3, 1e5)


def _pair(fields: Fields, key: str, default: tuple[float, float]) -> tuple[float, float]:
    """Two limits above 0, forward and turning; an infinite one means the default."""
    value = fields.get(key)
    if value is None:
        return default
    if not isinstance(value, list) or len(value) < 2:
        raise InvalidValue(fields.path(key), value, "two numbers [forward, turning]")
    first, second = (
        usual if v == math.inf else as_number(f"{fields.path(key)}[{i}]", v, 0.01, 100.0)
        for i, (v, usual) in enumerate(zip(value[:2], default, strict=True))
    )
    return first, second


def _lidar(fields: Fields) -> LidarSpec:
    for sensor in fields.each("sensors"):
        if "lidar2d" not in (sensor.get("name"), sensor.get("type")):
            log.warning("world_sensor_ignored", where=sensor.where)
            continue
        sensor.check_keys(_LIDAR_KEYS, others=True)
        if sensor.flag("noise"):
            log.warning("world_noise_ignored", where=sensor.path("noise"))
        near = sensor.number("range_min", 0.0, low=0.0, high=1000.0)
        mount = as_numbers(sensor.path("offset"), sensor.get("offset") or [0, 0, 0], 3)
        return LidarSpec(
            beams=sensor.whole("number", 100, low=1, high=10_000),
            angle_range_rad=min(sensor.positive("angle_range", math.pi), 2 * math.pi),
            range_min_m=near,
            range_max_m=sensor.number("range_max", 10.0, low=max(near, 0.01), high=1000.0),
            mount=Pose2D(*mount[:3]),
        )
    return LidarSpec()
