"""`robot-irsim`: the same robot in the same apartment, simulated with IR-SIM.

The world has a driven robot, solid walls, and furniture that slides when pushed. IR-SIM's rigid
contacts (`collision_mode: contact`) move a thing with a mass, as pymunk does, by another law: the
robot pushes a thing that its wheels' grip can overcome, without slowing down, and stands before a
heavier one. IR-SIM keeps its current world in variables of its modules, so one thread at a time
works with it, however many worlds there are.

`irsim_config` writes a world for IR-SIM: exactly the planner's knowledge, and nothing more. A
user's file is in IR-SIM's own format already. `robots/world` reads and checks it once, so that both
simulators and the planner see the same things in the same places, even the random ones. One thing
is added that IR-SIM would leave open: the world's edges are solid.
"""

import contextlib
import io
import tempfile
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError, InvalidValue, install_extra
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import BRAKE_M_S2, STEP_S, STILL_M_S, MotionState
from edgevox.robots.shapes import Circle, Line, Polygon, Shape, crosses_itself
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import LidarSpec, RobotSpec, World

log = get_logger(__name__)


Config = dict[str, Any]

GRAVITY_M_S2 = 9.81


def irsim_config(world: World) -> Config:
    """Return the content of IR-SIM's YAML file. Its objects are the robot, the things, the edges.

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


_ONE_AT_A_TIME = threading.Lock()


class IrsimEngine:
    """An `Engine` in IR-SIM, with its lidar, which casts its rays only when it is asked."""

    def __init__(self, world: World) -> None:
        """Raises `EdgeVoxError` where IR-SIM is not installed, `InvalidValue` for a bad world."""
        self._mount = world.robot.lidar.mount
        with _ONE_AT_A_TIME:
            self._env = make_environment(world)
        self._robot = self._env.robot
        self._lidar = self._robot.lidar
        self._robot.sensors.clear()
        objects = {one.name: one for one in self._env.obstacle_list}
        things = [objects[f"thing_{number}"] for number in range(len(world.things))]
        self._movable = [
            one for one, thing in zip(things, world.things, strict=True) if thing.movable
        ]
        self._names = {one.id: thing.name for one, thing in zip(things, world.things, strict=True)}
        for one in (self._robot, *self._movable):
            one.trajectory = deque(maxlen=1)  # IR-SIM would remember every step for ever

    def step(self, command: Twist2D) -> MotionState:
        with _ONE_AT_A_TIME:
            self._env.step([command.linear_m_s, command.angular_rad_s])
        return self.motion()

    def motion(self) -> MotionState:
        linear, angular = self._robot.velocity[:2, 0]
        touching = {self._names.get(one.id, "edge") for one in self._robot.contact.partners}
        return MotionState(
            _pose(self._robot), Twist2D(float(linear), float(angular)), frozenset(touching)
        )

    @property
    def still(self) -> bool:
        return all(
            float(np.abs(one.velocity).max()) < STILL_M_S for one in (self._robot, *self._movable)
        )

    def movable_poses(self) -> tuple[Pose2D, ...]:
        return tuple(_pose(one) for one in self._movable)

    def scan(self, time_s: float) -> LidarScan:
        """Return a sweep with IR-SIM's spacing of beams: a full circle has its first one twice."""
        lidar = self._lidar
        with _ONE_AT_A_TIME:
            lidar.step(self._robot.state[:3])
            hit = lidar.valid | (lidar.range_data < lidar.range_max)
            ranges = np.where(hit, lidar.range_data, np.inf)
        return LidarScan(
            time_s=time_s,
            angle_min_rad=float(lidar.angle_min),
            angle_increment_rad=float(lidar.angle_inc),
            range_min_m=float(lidar.range_min),
            range_max_m=float(lidar.range_max),
            ranges_m=ranges.astype(np.float32),
            mount=self._mount,
        )

    def put(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        with _ONE_AT_A_TIME:
            for one, pose in zip((self._robot, *self._movable), (robot, *movable), strict=True):
                one.set_state([pose.x_m, pose.y_m, pose.yaw_rad])
                one.set_velocity()
                one.contact.reset()
            self._env.build_tree()


def make_environment(world: World) -> Any:
    """Make IR-SIM's own environment; silent, since the terminal belongs to the agent."""
    config = irsim_config(world)
    irsim = _import()
    with tempfile.TemporaryDirectory(prefix="edgevox-irsim-") as folder:
        file = Path(folder, "world.yaml")
        file.write_text(yaml.safe_dump(config), encoding="utf-8")
        env = irsim.make(str(file), headless=True, log_level="CRITICAL")
    env.logger.close()
    return env


def _import() -> Any:
    """Import the package; its output goes to the log."""
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            import irsim
    except ImportError as error:
        raise EdgeVoxError(
            f"robot-irsim needs IR-SIM, and {error.name} cannot be imported: "
            f"{install_extra('irsim')}"
        ) from None
    for line in printed.getvalue().splitlines():
        log.info("irsim", line=line)
    return irsim


def _pose(one: Any) -> Pose2D:
    x, y, yaw = one.state[:3, 0]
    return Pose2D(float(x), float(y), float(yaw))


class IrsimRobot(DiffDriveRobot):
    """A `DiffDriveRobot` in IR-SIM, in the apartment or any other world.

    Walls are solid and furniture with a mass can be pushed, by IR-SIM's own law of contacts. Drives
    are planned and steered by EdgeVox, not by IR-SIM's goals and behaviours. It is deterministic;
    `load_world` and its seed decide the random parts of a world file. Raises `EdgeVoxError` if
    IR-SIM is not installed.
    """

    def __init__(
        self, world: World | None = None, *, speed: float | None = 1.0, clock: Clock | None = None
    ) -> None:
        world = world or load_world()
        super().__init__("robot-irsim", world, IrsimEngine(world), speed=speed, clock=clock)
