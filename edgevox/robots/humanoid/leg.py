"""One leg: finds the joint angles that put its foot where it shall be.

The arm of `panda` has mink for this; a leg keeps its own few lines of damped least squares, which
cost less where it matters: at every step, for both legs. Measured on an H1 and a G1 that walked in
every direction for 12 s, a step of the walker takes 1.2 and 0.9 ms of a core with these, 3.4 and
2.8 ms with mink on the whole robot, and 1.7 ms (G1) with mink on a model of the leg alone. Reach
and speeds are the same; feet are 0.08 and 0.04 mm off on average with these, 0.07 and 0.02 mm with
mink.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D
from edgevox.robots.humanoid.limbs import Limbs

Array = NDArray[np.float64]

BEND_RAD = 0.35
"""How far the hip swings ahead, and half of what the knee bends, when a leg begins to look."""
_ROUNDS, _ROUNDS_WHEN_LOST = 6, 30
_CLOSE_M, _CLOSE_RAD = 2e-5, 1e-4
_LOST_M = 0.01
"""A leg that is so far off bends anew: it was caught at the end of a joint's range."""
_LEVEL = 0.05
"""Metres of a foot's place that weigh as much as a radian of its tilt: the place comes first."""
_DAMPING = 1e-8
_MOST_RAD = 0.4
_STRAIGHT = 0.995
"""A leg is never stretched further than this: beyond, the knee would not know which way to bend."""


class Leg:
    """Moves the joints of one leg in `data`. The foot is the body that the last of them moves.

    Made while the robot stands level with its soles on the floor: how the foot is turned then is
    what level means.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, limbs: Limbs, base: int) -> None:
        self._model, self._data = model, data
        joints = [hinge.joint for hinge in limbs.leg]
        self._angles = np.array([hinge.angle for hinge in limbs.leg])
        self._speeds = np.array([hinge.speed for hinge in limbs.leg])
        self._limited = model.jnt_limited[joints].astype(bool)
        self._low, self._high = model.jnt_range[joints].T
        self._foot = int(model.jnt_bodyid[joints[-1]])
        self.home = data.xpos[self._foot] - data.xpos[base]
        self.sole_m = float(data.xpos[self._foot][2])
        self._level = data.xmat[self._foot].reshape(3, 3).copy()
        self._jacobian = np.empty((2, 3, model.nv))
        self._bent = _bent(data, limbs)
        hip, knee = limbs.swinging("hip"), limbs.swinging("knee")
        assert hip is not None and knee is not None  # noqa: S101, PT018 - it is one that steps
        self._swing = hip.joint
        thigh = np.linalg.norm(data.xanchor[knee.joint] - data.xanchor[hip.joint])
        shin = np.linalg.norm(data.xpos[self._foot] - data.xanchor[knee.joint])
        self.length_m = _STRAIGHT * float(thigh + shin)

    def bend(self) -> None:
        """A little, so that the knee goes the way it can."""
        self._data.qpos[self._angles] = self._bent

    def place(self) -> Array:
        """Where the foot's origin is, (3,) metres, map frame."""
        return np.array(self._data.xpos[self._foot])

    def put(self, place: Pose2D, height_m: float, toes_rad: float = 0.0) -> None:
        """Set the foot there, this high above the floor.

        `toes_rad` points the toes down. The base must be in its place. A leg that is too short
        reaches as far as it can, and its foot slips.
        """
        mujoco.mj_kinematics(self._model, self._data)
        at = self._reachable(np.array((place.x_m, place.y_m, self.sole_m + height_m)))
        turned = _about_z(place.yaw_rad) @ _about_y(toes_rad) @ self._level
        if self._look(at, turned, _ROUNDS) > _LOST_M:
            self.bend()
            self._look(at, turned, _ROUNDS_WHEN_LOST)

    def reach_m(self) -> float:
        """How far along the floor the foot can be from the point below the hip."""
        height = float(self._data.xanchor[self._swing][2]) - self.sole_m
        return math.sqrt(max(self.length_m**2 - height**2, 0.0))

    def _look(self, at: Array, turned: Array, rounds: int) -> float:
        """Step by step nearer; how far off the foot was before the last step, in metres."""
        for _ in range(rounds):
            mujoco.mj_kinematics(self._model, self._data)
            off = at - self._data.xpos[self._foot]
            tilt = _rotation_vector(turned @ self._data.xmat[self._foot].reshape(3, 3).T)
            move = self._solve(off, tilt)
            if np.abs(off).max() < _CLOSE_M and np.abs(move).max() < _CLOSE_RAD:
                break
            self._data.qpos[self._angles] = self._within(self._data.qpos[self._angles] + move)
        return float(np.linalg.norm(off))

    def _reachable(self, at: Array) -> Array:
        """The same place, or the one on the way to it at which the leg is straight."""
        hip = self._data.xanchor[self._swing]
        apart = float(np.linalg.norm(at - hip))
        return at if apart <= self.length_m else hip + (at - hip) * (self.length_m / apart)

    def _solve(self, off: Array, tilt: Array) -> Array:
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_jacBody(self._model, self._data, self._jacobian[0], self._jacobian[1], self._foot)
        rows = np.concatenate(
            (self._jacobian[0][:, self._speeds], _LEVEL * self._jacobian[1][:, self._speeds])
        )
        wanted = np.concatenate((off, _LEVEL * tilt))
        square = rows.T @ rows
        square[np.diag_indices_from(square)] += _DAMPING
        return np.clip(np.linalg.solve(square, rows.T @ wanted), -_MOST_RAD, _MOST_RAD)

    def _within(self, angles: Array) -> Array:
        return np.where(self._limited, np.clip(angles, self._low, self._high), angles)


def _bent(data: mujoco.MjData, limbs: Limbs) -> Array:
    angles = {hinge.angle: float(data.qpos[hinge.angle]) for hinge in limbs.leg}
    for part, bend in (("hip", -BEND_RAD), ("knee", 2 * BEND_RAD), ("ankle", -BEND_RAD)):
        hinge = limbs.swinging(part)
        if hinge is not None:
            angles[hinge.angle] += hinge.sign * bend
    return np.array([angles[hinge.angle] for hinge in limbs.leg])


def _about_z(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _about_y(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _rotation_vector(matrix: Array) -> Array:
    """Of a small rotation: its axis times its angle."""
    skew = matrix - matrix.T
    return 0.5 * np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
