"""The interface of a walker, and the base that it moves: the robot's pelvis.

A walker is a policy in physics, or a gait that sets joints and base.
"""

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D, rotate
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid.walking_policy import WalkingCommand

FALLEN_TILT_RAD = math.radians(55.0)
FALLEN_HEIGHT = 0.6
"""The share of the standing height below which the robot has fallen."""
_COS_FALLEN = math.cos(FALLEN_TILT_RAD)


class FloatingBase:
    """Reads and writes the free joint of one body. `place` is the index of its first `qpos`.

    It is read in every period, so it works with plain numbers, which are fastest.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, name: str) -> None:
        joint = model.jnt(model.body(name).jntadr[0])
        self._model, self._data = model, data
        self.place, self.speed = int(joint.qposadr[0]), int(joint.dofadr[0])
        self._at = data.qpos[self.place : self.place + 7]
        self._moves = data.qvel[self.speed : self.speed + 6]
        self._geoms = _geoms_below(model, model.body(name).id)
        self.stand_height_m = 1.0
        self.fallen = False
        self._see()

    @property
    def pose(self) -> Pose2D:
        """The pose on the floor at the last look."""
        return self._pose

    @property
    def height_m(self) -> float:
        """The height of the base above the floor."""
        return float(self._at[2])

    @property
    def finite(self) -> bool:
        """Whether every number of its pose and velocity is finite."""
        return self._pose.finite and math.isfinite(sum(self._moves.tolist()))

    def velocity(self) -> Twist2D:
        """Ahead along the floor, and turning."""
        vx, vy, _, roll, pitch, yaw_rate = self._moves.tolist()
        up_x, up_y, up_z = self._up
        turn = roll * up_x + pitch * up_y + yaw_rate * up_z
        ahead_m_s, _ = rotate(vx, vy, -self._pose.yaw_rad)
        return Twist2D(ahead_m_s, turn)

    def turning_rad_s(self) -> NDArray[np.float64]:
        """Angular velocity (3,) in its own axes."""
        return np.array(self._moves[3:6])

    def gravity(self) -> NDArray[np.float64]:
        """The unit vector (3,) that points down, in its own axes."""
        x, y, z = self._up
        return np.array((-x, -y, -z))

    def update(self) -> None:
        """Look where it is now; a fall counts until it got up."""
        height_m = self._see()
        low = height_m < FALLEN_HEIGHT * self.stand_height_m
        self.fallen = self.fallen or low or self._up[2] < _COS_FALLEN

    def got_up(self) -> None:
        """Mark the robot as standing again."""
        self.fallen = False
        self._see()

    def move_to(self, pose: Pose2D) -> None:
        """Turn and move it there along the floor; height and tilt stay as they are."""
        self._see()
        half = (pose.yaw_rad - self._pose.yaw_rad) / 2
        about_z = np.array((math.cos(half), 0.0, 0.0, math.sin(half)))
        turned = np.empty(4)
        mujoco.mju_mulQuat(turned, about_z, self._at[3:7])
        self._at[:2] = pose.x_m, pose.y_m
        self._at[3:7] = turned
        self._see()

    def lowest_m(self) -> float:
        """Height of the robot's lowest point; the kinematics must be up to date."""
        lows = [_lowest(self._model, self._data, geom) for geom in self._geoms]
        return min(lows, default=self.height_m)

    def _see(self) -> float:
        """Take its pose and the unit vector that points up in its own axes; its height."""
        x, y, z, qw, qx, qy, qz = self._at.tolist()
        yaw = math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
        self._pose = Pose2D(x, y, yaw)
        self._up = (
            2 * (qx * qz - qw * qy),
            2 * (qy * qz + qw * qx),
            1 - 2 * (qx * qx + qy * qy),
        )
        return float(z)


def _geoms_below(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the robot's geoms that can touch the floor; all, if none is meant to touch."""
    own = [
        geom for geom in range(model.ngeom) if model.body_rootid[model.geom_bodyid[geom]] == body
    ]
    solid = [geom for geom in own if model.geom_contype[geom] or model.geom_conaffinity[geom]]
    return solid or own


def _lowest(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Height of a geom's lowest point, by its box, or by its two ends if it is a capsule."""
    rotation = data.geom_xmat[geom].reshape(3, 3)
    middle, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
    kind, size = model.geom_type[geom], model.geom_size[geom]
    centre = float(data.geom_xpos[geom][2])
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return centre - float(size[0])
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return centre - float(size[0] + size[1] * abs(rotation[2, 2]))
    return centre + float(rotation[2] @ middle - np.abs(rotation[2]) @ half)


PERIOD_S = 0.02
"""The world's time that passes with each step of a walker that has no policy."""


@dataclass(frozen=True, slots=True)
class WalkerLimits:
    """The top speeds of a walker, and the precision with which a walk ends.

    The defaults are for a robot whose base is moved without physics: it does not coast.
    """

    forward_m_s: float
    left_m_s: float
    turn_rad_s: float
    slowest_m_s: float = 0.0
    """The slowest walk."""
    slowest_rad_s: float = 0.0
    """The slowest turn."""
    coast_m: float = 1e-6
    """A walk stops this far before its end, because the robot coasts."""
    near_m: float = 1e-6
    """The same for a few slow steps."""
    near_rad: float = 1e-6
    """The same for a turn."""
    exact_m: float = 1e-5
    """The error that is accepted once it stands."""
    exact_rad: float = 1e-5
    """The error that is accepted once it stands."""
    settle_s: float = 0.0
    """Seconds until it stands."""


class Walker(Protocol):
    """Lets a robot walk, one `period_s` after the other. Not thread-safe."""

    @property
    def simulation(self) -> Literal["physics", "kinematic"]:
        """The kind of simulation: "physics" if forces move the robot, else "kinematic"."""

    @property
    def name(self) -> str:
        """The source of its steps."""

    @property
    def model(self) -> mujoco.MjModel: ...

    @property
    def data(self) -> mujoco.MjData: ...

    @property
    def base(self) -> FloatingBase: ...

    @property
    def limits(self) -> WalkerLimits: ...

    @property
    def period_s(self) -> float: ...

    def step(self, wanted: WalkingCommand) -> None:
        """Let `period_s` pass, walking at this velocity as well as it can."""

    def put(self, pose: Pose2D) -> None:
        """Stand upright there, at rest."""
