"""A walker without physics: the base's pose is set, the legs follow, the arms swing."""

import math
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from edgevox.core.transforms import Pose2D, rotate
from edgevox.robots.humanoid.gait import (
    AHEAD_S,
    BEND_RAD,
    CYCLE_S,
    LIFT_M,
    Footstep,
    FootstepPlanner,
    Hinge,
    Leg,
    Limbs,
    ahead,
    find_limbs,
)
from edgevox.robots.humanoid.walker import PERIOD_S, FloatingBase, WalkerLimits
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand

CROUCH = 0.06
"""Lowering of the body against straight legs, as a share of the legs' length."""
FASTEST_M_S, FASTEST_RAD_S = 0.6, 0.9
_LIFT = 0.1
"""The highest lift of a foot, as a share of its leg's length."""
_STRIDE = 0.8
"""The share of the legs' reach that strides take."""
_EASE_S = 0.25
"""Seconds in which a swing builds up and dies away."""
_FULL_M_S = 0.4
_TOES_RAD = 0.2


@dataclass(frozen=True, slots=True)
class Swing:
    """A joint that swings with the steps, by so much about its angle at rest.

    `turn` is the part of a cycle by which it comes later than the left foot.
    """

    hinge: Hinge
    rest_rad: float
    ahead_rad: float
    turn: float


class KinematicWalker:
    """Follows the asked velocity exactly."""

    simulation: Literal["kinematic"] = "kinematic"
    name = "procedural gait"
    period_s = PERIOD_S

    def __init__(self, model: mujoco.MjModel, base: str) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self.base = FloatingBase(model, self.data, base)
        mujoco.mj_kinematics(model, self.data)
        self.data.qpos[self.base.place + 2] -= self.base.lowest_m()
        self.base.move_to(Pose2D(0.0, 0.0, 0.0))
        mujoco.mj_kinematics(model, self.data)
        limbs = find_limbs(model, self.data)
        body = model.body(base).id
        can_step = all(side.steps for side in limbs)
        self._legs = [Leg(model, self.data, side, body) for side in limbs] if can_step else []
        self._swings = _swings(model, self.data, limbs, legs=not can_step)
        self._crouch()
        self.base.stand_height_m = self.base.height_m
        homes = [Pose2D(float(leg.home[0]), float(leg.home[1]), 0.0) for leg in self._legs]
        left, right = homes or [Pose2D(0.0, 0.1, 0.0), Pose2D(0.0, -0.1, 0.0)]
        self._width_m = abs(left.y_m - right.y_m) / 2
        lift = min((_LIFT * leg.length_m for leg in self._legs), default=LIFT_M)
        self._steps = FootstepPlanner((left, right), self.base.pose, min(lift, LIFT_M))
        self.limits = self._find_limits()
        self._ease, self._rests = 0.0, False
        self._home = self.data.qpos.copy()
        self.put(Pose2D(0.0, 0.0, 0.0))

    def step(self, wanted: WalkingCommand) -> None:
        self.data.time += self.period_s
        velocity = self._limited(wanted)
        if velocity.stands and self._rests:
            return  # a robot that stands still costs nothing but its time
        self.base.move_to(ahead(self.base.pose, velocity, self.period_s))
        self._set_speed(velocity)
        self._steps.advance(self.period_s, self.base.pose, velocity)
        self._swing(velocity)
        for leg, foot in zip(self._legs, self._steps.feet, strict=False):
            leg.put(foot.place, foot.height_m, _toes(foot))
        mujoco.mj_kinematics(self.model, self.data)
        self._rests = velocity.stands and not self._ease and self._steps.phase == 0.0

    def put(self, pose: Pose2D) -> None:
        self.data.qpos[:] = self._home
        self.data.qvel[:] = 0.0
        self.base.move_to(pose)
        self._steps.put(pose)
        self._ease, self._rests = 0.0, False
        self.step(STAND)
        self.base.got_up()

    def feet(self) -> tuple[tuple[Footstep, np.ndarray], ...]:
        """Return each stepping leg's wanted footstep and its foot's position, (3,) metres."""
        return tuple(
            (foot, leg.place()) for foot, leg in zip(self._steps.feet, self._legs, strict=False)
        )

    @property
    def stepping(self) -> bool:
        """Whether a foot is in the air."""
        return self._steps.stepping

    def _crouch(self) -> None:
        """Down a little, with bent knees, so that the feet can reach ahead."""
        if not self._legs:
            return
        length = min(abs(float(leg.home[2])) for leg in self._legs)
        self.data.qpos[self.base.place + 2] -= CROUCH * length
        for leg in self._legs:
            leg.bend()
            for _ in range(10):
                leg.put(Pose2D(float(leg.home[0]), float(leg.home[1]), 0.0), 0.0)

    def _find_limits(self) -> WalkerLimits:
        """Derive the limits from the legs: a standing foot must stay within reach."""
        reaches = [leg.reach_m() for leg in self._legs]
        forward = min(FASTEST_M_S, _STRIDE * min(reaches, default=math.inf) / AHEAD_S)
        turn = min(FASTEST_RAD_S, forward / max(self._width_m, 1e-3))
        return WalkerLimits(forward, forward / 2, turn, settle_s=CYCLE_S)

    def _limited(self, wanted: WalkingCommand) -> WalkingCommand:
        """Slower on the same arc, if the outer foot could not keep up."""
        limits = self.limits
        forward = _within(wanted.forward_m_s, limits.forward_m_s)
        left = _within(wanted.left_m_s, limits.left_m_s)
        turn = _within(wanted.turn_rad_s, limits.turn_rad_s)
        fastest = abs(forward) + abs(left) + abs(turn) * self._width_m
        slower = min(1.0, limits.forward_m_s / fastest) if fastest else 1.0
        return WalkingCommand(slower * forward, slower * left, slower * turn)

    def _set_speed(self, velocity: WalkingCommand) -> None:
        pose, speed = self.base.pose, self.base.speed
        x_m_s, y_m_s = rotate(velocity.forward_m_s, velocity.left_m_s, pose.yaw_rad)
        self.data.qvel[speed] = x_m_s
        self.data.qvel[speed + 1] = y_m_s
        self.data.qvel[speed + 5] = velocity.turn_rad_s

    def _swing(self, velocity: WalkingCommand) -> None:
        speed = math.hypot(velocity.forward_m_s, velocity.left_m_s) + 0.3 * abs(velocity.turn_rad_s)
        full = min(speed / _FULL_M_S, 1.0) * math.copysign(1.0, velocity.forward_m_s)
        step = self.period_s / _EASE_S
        self._ease += _within(full - self._ease, step)
        for swing in self._swings:
            wave = math.cos(math.tau * (self._steps.phase - 0.4 - swing.turn))
            ahead_rad = self._ease * swing.ahead_rad * wave
            self.data.qpos[swing.hinge.angle] = swing.rest_rad - swing.hinge.sign * ahead_rad


def _swings(
    model: mujoco.MjModel, data: mujoco.MjData, limbs: tuple[Limbs, Limbs], *, legs: bool
) -> list[Swing]:
    """Arms swing against the legs of their side; legs that cannot step swing as well."""
    much = {"shoulder": 0.35, "elbow": 0.2}
    if legs:
        much |= {"hip": BEND_RAD, "knee": -BEND_RAD, "ankle": BEND_RAD / 2}
    found = []
    for number, side in enumerate(limbs):
        for part, ahead_rad in much.items():
            hinge = side.swinging(part)
            if hinge is None:
                continue
            arm = part in ("shoulder", "elbow")
            rest_rad = _inside(model, hinge, float(data.qpos[hinge.angle]), abs(ahead_rad))
            found.append(Swing(hinge, rest_rad, ahead_rad, 0.5 * (number + arm)))
    return found


def _inside(model: mujoco.MjModel, hinge: Hinge, rest_rad: float, margin: float) -> float:
    """The angle nearest to `rest_rad` from which it can swing both ways."""
    if not model.jnt_limited[hinge.joint]:
        return rest_rad
    low, high = model.jnt_range[hinge.joint]
    if high - low < 2 * margin:
        return float(low + high) / 2
    return float(min(max(rest_rad, low + margin), high - margin))


def _toes(foot: Footstep) -> float:
    """Pushing off toes down, coming down toes up."""
    return 0.0 if foot.swing is None else _TOES_RAD * math.sin(math.tau * foot.swing)


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)
