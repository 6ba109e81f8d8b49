"""The 2D world in IR-SIM: a driven robot, solid walls, furniture that slides when pushed.

IR-SIM's rigid contacts (`collision_mode: contact`) move what has a mass, as pymunk does, with
another law: a robot pushes what its wheels' grip can overcome and does not slow down, and stands
before what is heavier. IR-SIM keeps the world that it works on in variables of its modules, so one
thread at a time works with it, however many worlds there are.
"""

import contextlib
import io
import tempfile
import threading
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.engine import STILL_M_S, MotionState
from edgevox.robots.irsim_world import irsim_config
from edgevox.robots.world_model import World

log = get_logger(__name__)

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
        """As IR-SIM spreads the beams: a full circle has its first one twice."""
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
    """IR-SIM's own environment; silent, since the terminal belongs to somebody else."""
    config = irsim_config(world)
    irsim = _import()
    with tempfile.TemporaryDirectory(prefix="edgevox-irsim-") as folder:
        file = Path(folder, "world.yaml")
        file.write_text(yaml.safe_dump(config), encoding="utf-8")
        env = irsim.make(str(file), headless=True, log_level="CRITICAL")
    env.logger.close()
    return env


def _import() -> Any:
    """The package; what it prints goes to the log."""
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
