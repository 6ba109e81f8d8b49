"""The procedural gait: footsteps, leg kinematics and the search for legs and arms in a model.

`FootstepPlanner` plants one foot and swings the other, so that the standing foot does not slip.

`Leg` finds the joint angles that put a foot in a given place. The arm of `panda` has mink for this;
a leg has a few lines of damped least squares, which cost less where it matters: at every step, for
both legs. Measured on an H1 and a G1 that walked in every direction for 12 s, a step of the walker
takes 1.2 and 0.9 ms of a core with these, 3.4 and 2.8 ms with mink on the whole robot, and 1.7 ms
(G1) with mink on a model of the leg alone. Reach and speeds are the same; feet are 0.08 and 0.04 mm
off on average with these, 0.07 and 0.02 mm with mink.

`find_limbs` finds a robot's legs and arms by their joints' names and axes.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D, compose_on_floor, distance_on_floor, turn_between
from edgevox.robots.humanoid.walking_policy import WalkingCommand

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")
_PART = {
    "hip": re.compile("hip"),
    "knee": re.compile("knee"),
    "ankle": re.compile("ank"),
    "shoulder": re.compile("sho"),
    "elbow": re.compile("elbow|(?:^|[_.])el(?=[_.]|$)"),
}
_SIDE = {
    "left": re.compile(r"left|(?:^|[_.])l(?=[_.]|$)"),
    "right": re.compile(r"right|(?:^|[_.])r(?=[_.]|$)"),
}
_PITCH = 0.7
"""A joint that turns about the y axis, to less than 45 degrees, swings a limb ahead and back."""


@dataclass(frozen=True, slots=True)
class Hinge:
    """A joint of a limb."""

    joint: int
    """Its number in the model."""
    angle: int
    """The index of its angle in `qpos`."""
    speed: int
    """The index of its speed in `qvel`."""
    sign: int
    """1 if, as about the y axis, a positive angle swings a hanging limb back; else -1."""
    pitches: bool
    """Whether it swings ahead and back at all."""


@dataclass(frozen=True)
class Limbs:
    """The hinges of one side by part ("hip", "knee", ...), in the order of the model."""

    parts: dict[str, tuple[Hinge, ...]]

    @property
    def leg(self) -> tuple[Hinge, ...]:
        """The joints from the hip down."""
        return self.parts["hip"] + self.parts["knee"] + self.parts["ankle"]

    @property
    def steps(self) -> bool:
        """Whether this leg can take a step: it has a hip and a knee that swing."""
        return all(self.swinging(part) is not None for part in ("hip", "knee"))

    def swinging(self, part: str) -> Hinge | None:
        """The joint of this part that swings ahead and back."""
        return next((hinge for hinge in self.parts[part] if hinge.pitches), None)


def find_limbs(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Limbs, Limbs]:
    """Left and right, whatever was found. The kinematics must be up to date, the base level."""
    names = [model.joint(number).name.lower() for number in range(model.njnt)]
    left, right = (_limbs(model, data, names, side) for side in SIDES)
    return left, right


def _limbs(model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str], side: Side) -> Limbs:
    own = [
        number
        for number, name in enumerate(names)
        if _SIDE[side].search(name) and model.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
    ]
    return Limbs(
        {
            part: tuple(
                _hinge(model, data, number) for number in own if called.search(names[number])
            )
            for part, called in _PART.items()
        },
    )


def _hinge(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> Hinge:
    about_y = float(data.xaxis[number][1])
    return Hinge(
        joint=number,
        angle=int(model.jnt_qposadr[number]),
        speed=int(model.jnt_dofadr[number]),
        sign=1 if about_y >= 0 else -1,
        pitches=abs(about_y) > _PITCH,
    )


Array = NDArray[np.float64]

BEND_RAD = 0.35
"""The hip's forward swing, and half of the knee's bend, with which the search for angles starts."""
_ROUNDS, _ROUNDS_WHEN_LOST = 6, 30
_CLOSE_M, _CLOSE_RAD = 2e-5, 1e-4
_LOST_M = 0.01
"""A leg that is so far off starts again from bent: it was caught at the end of a joint's range."""
_LEVEL = 0.05
"""Metres of a foot's place that weigh as much as a radian of its tilt: the place comes first."""
_DAMPING = 1e-8
_MOST_RAD = 0.4
_STRAIGHT = 0.995
"""A leg is never stretched further than this: beyond, the knee would not know which way to bend."""


class Leg:
    """Moves the joints of one leg in `data`. The foot is the body that the last joint moves.

    Create it while the robot stands level with its soles on the floor: the foot's orientation at
    that time is level.
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
        """Return the position of the foot's origin, (3,) metres, map frame."""
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
        """Return how far along the floor the foot can be from the point below the hip."""
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
    """Return the rotation vector (axis times angle) of a small rotation."""
    skew = matrix - matrix.T
    return 0.5 * np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


CYCLE_S = 0.9
"""Seconds in which both feet have stepped once."""
SWING = 0.4
"""The part of a cycle in which one foot is in the air."""
LIFT_M = 0.06
AHEAD_S = (1.0 - SWING) / 2 * CYCLE_S
"""Seconds from touching down to the middle of standing on a foot."""
_AT_HOME_M = 1e-3
_AT_HOME_RAD = 2e-3


@dataclass(frozen=True, slots=True)
class Footstep:
    """A foot: where it is on the floor, how high above it, and how far through its swing (0 to 1).

    `swing` is None while it stands.
    """

    place: Pose2D
    height_m: float = 0.0
    swing: float | None = None


class FootstepPlanner:
    """Plans the steps of two feet, which start at their homes.

    `homes` are the feet's places beside the base: (left, right) in its frame. A swinging foot is
    lifted by `lift_m`. While the base moves the feet step by turns; once it stands they step until
    both are at home.
    """

    def __init__(self, homes: tuple[Pose2D, Pose2D], base: Pose2D, lift_m: float = LIFT_M) -> None:
        self._homes, self._lift_m = homes, lift_m
        self.phase = 0.0
        self.put(base)

    def put(self, base: Pose2D) -> None:
        """Put both feet at home beside a base at this pose."""
        self.phase = 0.0
        self.feet = [Footstep(compose_on_floor(base, home)) for home in self._homes]
        self._from = [foot.place for foot in self.feet]

    @property
    def stepping(self) -> bool:
        """Whether a foot is in the air."""
        return any(foot.swing is not None for foot in self.feet)

    def advance(self, seconds: float, base: Pose2D, velocity: WalkingCommand) -> None:
        """Let the feet follow a base that is there and moves so."""
        if velocity.stands and not self.stepping and self._at_home(base):
            self.phase = 0.0
            return
        self.phase = (self.phase + seconds / CYCLE_S) % 1.0
        for number in (0, 1):
            self._move(number, base, velocity)

    def _move(self, number: int, base: Pose2D, velocity: WalkingCommand) -> None:
        through = ((self.phase - 0.5 * number) % 1.0) / SWING
        foot = self.feet[number]
        if through >= 1.0:
            if foot.swing is not None:
                self.feet[number] = Footstep(foot.place)
            return
        if foot.swing is None:
            self._from[number] = foot.place
        left_s = (1.0 - through) * SWING * CYCLE_S
        later = ahead(base, velocity, left_s + AHEAD_S)
        target = compose_on_floor(later, self._homes[number])
        smooth = through * through * (3.0 - 2.0 * through)
        place = between(self._from[number], target, smooth)
        height_m = self._lift_m * math.sin(math.pi * through) ** 2
        self.feet[number] = Footstep(place, height_m, through)

    def _at_home(self, base: Pose2D) -> bool:
        return all(
            _near(foot.place, compose_on_floor(base, home))
            for foot, home in zip(self.feet, self._homes, strict=True)
        )


def ahead(base: Pose2D, velocity: WalkingCommand, seconds: float) -> Pose2D:
    """Return the pose of a base that goes on like this: along an arc."""
    turned = velocity.turn_rad_s * seconds
    if abs(turned) < 1e-6:
        along, across = 1.0, 0.0
    else:
        along, across = math.sin(turned) / turned, (1.0 - math.cos(turned)) / turned
    x, y = velocity.forward_m_s * seconds, velocity.left_m_s * seconds
    return compose_on_floor(base, Pose2D(along * x - across * y, across * x + along * y, turned))


def between(one: Pose2D, other: Pose2D, part: float) -> Pose2D:
    """Interpolate between two poses, straight; yaw takes the short way round."""
    turn = turn_between(one.yaw_rad, other.yaw_rad)
    return Pose2D(
        one.x_m + part * (other.x_m - one.x_m),
        one.y_m + part * (other.y_m - one.y_m),
        one.yaw_rad + part * turn,
    )


def _near(one: Pose2D, other: Pose2D) -> bool:
    turned = abs(turn_between(one.yaw_rad, other.yaw_rad))
    return distance_on_floor(one, other) < _AT_HOME_M and turned < _AT_HOME_RAD
