"""Writes a world as IR-SIM wants it: exactly what the planner knows, and nothing else.

The file that a user gives is in IR-SIM's own format already. It is read and checked once, by
`world.py`, and handed on from there, so that both simulators and the planner see the same things in
the same places, also those that the file leaves to chance. What IR-SIM would leave open is added:
the world's edges are solid.
"""

from collections.abc import Iterator
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.engine import BRAKE_M_S2, STEP_S
from edgevox.robots.shapes import Circle, Line, Polygon, Shape, crosses_itself
from edgevox.robots.world_model import LidarSpec, RobotSpec, World

Config = dict[str, Any]

GRAVITY_M_S2 = 9.81


def irsim_config(world: World) -> Config:
    """What to write into IR-SIM's YAML file. The objects are the robot, the things, the edges.

    Raises `InvalidValue` for a shape that IR-SIM cannot stand in the world.
    """
    extent = {"width": world.width_m, "height": world.height_m}
    return {
        "world": {
            **extent,
            "offset": [world.x_min_m, world.y_min_m],
            "step_time": STEP_S,
            "collision_mode": "contact",  # the usual "stop" stops for good
            "gravity": GRAVITY_M_S2,
        },
        "robot": [_robot(world.robot)],
        "obstacle": [*_things(world), *_edges(world)],
    }


def _robot(spec: RobotSpec) -> Config:
    linear, angular = spec.max_linear_m_s, spec.max_angular_rad_s
    return {
        "name": "robot",
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": spec.radius_m},
        "state": _state(spec.start),
        "vel_min": [-linear, -angular],
        "vel_max": [linear, angular],
        "mass": spec.mass_kg,
        # Our ramp keeps the accelerations; the wheels grip as hard as the brakes are.
        "friction": BRAKE_M_S2 / GRAVITY_M_S2,
        "sensors": [_lidar(spec.lidar)],
    }


def _lidar(spec: LidarSpec) -> Config:
    return {
        "name": "lidar2d",
        "number": spec.beams,
        "angle_range": spec.angle_range_rad,
        "range_min": spec.range_min_m,
        "range_max": spec.range_max_m,
        "offset": _state(spec.mount),
    }


def _things(world: World) -> Iterator[Config]:
    for number, thing in enumerate(world.things):
        body = {"mass": thing.mass_kg, "friction": thing.friction} if thing.movable else {}
        yield {
            "name": f"thing_{number}",  # IR-SIM wants every name once, people do not
            "shape": _shape(thing.name, thing.parts),
            "state": _state(thing.pose),
            **body,
        }


def _edges(world: World) -> Iterator[Config]:
    for number, (x1, y1, x2, y2) in enumerate(world.border.tolist()):
        line = {"name": "linestring", "vertices": [[x1, y1], [x2, y2]]}
        yield {"name": f"edge_{number}", "shape": line, "state": [0, 0, 0]}


def _shape(name: str, parts: tuple[Shape, ...]) -> Config:
    if len(parts) == 1:
        return _part(name, parts[0])
    return {"name": "compound", "parts": [_part(name, part) for part in parts]}


def _part(name: str, part: Shape) -> Config:
    match part:
        case Circle(center, radius_m):
            return {"name": "circle", "radius": radius_m, "center": list(center)}
        case Line(vertices):
            return {"name": "linestring", "vertices": [list(v) for v in vertices]}
        case Polygon(vertices):
            if crosses_itself(part):
                corners = [list(v) for v in vertices]
                raise InvalidValue(
                    f"obstacle {name!r}: shape.vertices", corners, "sides that do not cross"
                )
            return {"name": "polygon", "vertices": [list(v) for v in vertices]}


def _state(pose: Pose2D) -> list[float]:
    return [pose.x_m, pose.y_m, pose.yaw_rad]
