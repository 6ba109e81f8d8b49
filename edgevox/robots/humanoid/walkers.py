"""The two walkers: one without physics, and one in physics.

`KinematicWalker` sets the base's pose; the legs follow, and the arms swing. Of `PhysicsWalker` a
policy moves position servos, and MuJoCo does the rest.
"""

import math
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D, rotate
from edgevox.robots.command_mux import clamped
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
from edgevox.robots.humanoid.walking_policy import (
    STAND,
    Observation,
    WalkingCommand,
    WalkingPlan,
    WalkingPolicy,
)

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
        forward = clamped(wanted.forward_m_s, limits.forward_m_s)
        left = clamped(wanted.left_m_s, limits.left_m_s)
        turn = clamped(wanted.turn_rad_s, limits.turn_rad_s)
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
        self._ease += clamped(full - self._ease, step)
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


SETTLE_S = 1.5
"""Seconds from walking to standing: the foot in the air is set down, and the sway dies away."""
_START_S = 2.0
_JITTER_RAD = 0.02
_CLEARANCE_M = 0.005


def fit_servos(spec: mujoco.MjSpec, plan: WalkingPlan) -> None:
    """Give the robot the servos and the rates that a policy wants. Raises `InvalidValue`."""
    spec.option.timestep = plan.timestep_s
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    servos = zip(plan.joints, plan.stiffness, plan.damping, plan.armature, strict=True)
    for name, stiffness, damping, armature in servos:
        joint = spec.joint(name)
        if joint is None or joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            known = ", ".join(sorted(one.name for one in spec.joints if one.name))
            raise InvalidValue("policy", name, f"a hinge that the robot has, one of {known}")
        joint.armature, joint.frictionloss = armature, 0.0
        actuator = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=stiffness, kv=damping)


class PhysicsWalker:
    """Follows `policy`. `generator` makes the slight unevenness of each start."""

    simulation: Literal["physics"] = "physics"

    def __init__(
        self,
        model: mujoco.MjModel,
        base: str,
        policy: WalkingPolicy,
        generator: np.random.Generator,
    ) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self.base = FloatingBase(model, self.data, base)
        self._qpos, self._qvel, self._ctrl = self.data.qpos, self.data.qvel, self.data.ctrl
        self._policy, self._plan = policy, policy.plan
        joints = [model.joint(name) for name in self._plan.joints]
        self._angles = np.array([joint.qposadr[0] for joint in joints])
        self._speeds = np.array([joint.dofadr[0] for joint in joints])
        self.period_s, self._substeps = self._plan.period_s, self._plan.steps
        self.limits = _limits(self._plan)
        self._wanted = self._asked = STAND
        self._begin(generator)

    @property
    def name(self) -> str:
        return self._policy.name

    def step(self, wanted: WalkingCommand) -> None:
        if self.base.fallen:
            self._ctrl[:] = self._qpos[self._angles]  # limp: only the damping is left
        else:
            self._ctrl[:] = self._policy.act(self._observe(self._command(wanted)))
        before_s = self.data.time
        mujoco.mj_step(self.model, self.data, self._substeps)
        if self.data.time <= before_s:  # numbers that are none made MuJoCo reset itself
            raise ArithmeticError("the robot's motion became infinite; it was put upright")
        self.base.update()

    def put(self, pose: Pose2D) -> None:
        mujoco.mj_resetData(self.model, self.data)
        self._qpos[:] = self._home
        self.base.move_to(pose)
        self._ctrl[:] = self._plan.stand_rad
        self._policy.reset()
        mujoco.mj_forward(self.model, self.data)
        self.base.got_up()

    def _begin(self, generator: np.random.Generator) -> None:
        """Let it come to a calm stand, and remember how it stands."""
        mujoco.mj_resetData(self.model, self.data)
        jitter = generator.uniform(-_JITTER_RAD, _JITTER_RAD, len(self._angles))
        self._qpos[self._angles] = self._plan.stand_rad + jitter
        self._qpos[self.base.place + 2] += self._drop() + _CLEARANCE_M
        self.base.stand_height_m = self.base.height_m
        self._policy.reset()
        self.base.got_up()
        for _ in range(round(_START_S / self.period_s)):
            self.step(STAND)
        if self.base.fallen:
            expected = "a walking policy that keeps this robot on its feet"
            raise InvalidValue("policy", self._policy.name, expected)
        self.base.stand_height_m = self.base.height_m
        self._home = self.data.qpos.copy()
        self.put(Pose2D(0.0, 0.0, 0.0))

    def _drop(self) -> float:
        """Return the height by which to move the base so that the lowest part touches the floor."""
        mujoco.mj_kinematics(self.model, self.data)
        return -self.base.lowest_m()

    def _command(self, wanted: WalkingCommand) -> WalkingCommand:
        """Return the command for a policy that walks slower than it is asked to."""
        if wanted is self._wanted:
            return self._asked
        plan = self._plan
        forward, left, turn = plan.follows
        self._wanted, self._asked = (
            wanted,
            WalkingCommand(
                clamped(wanted.forward_m_s / forward, plan.max_forward_m_s),
                clamped(wanted.left_m_s / left, plan.max_left_m_s),
                clamped(wanted.turn_rad_s / turn, plan.max_turn_rad_s),
            ),
        )
        return self._asked

    def _observe(self, command: WalkingCommand) -> Observation:
        return Observation(
            command,
            self.base.turning_rad_s(),
            self.base.gravity(),
            self._qpos.take(self._angles),
            self._qvel.take(self._speeds),
        )


def _limits(plan: WalkingPlan) -> WalkerLimits:
    forward, left, turn = plan.follows
    return WalkerLimits(
        forward_m_s=plan.max_forward_m_s * forward,
        left_m_s=plan.max_left_m_s * left,
        turn_rad_s=plan.max_turn_rad_s * turn,
        slowest_m_s=0.1,
        slowest_rad_s=0.15,
        coast_m=0.11,
        near_m=0.04,
        near_rad=math.radians(0.5),
        exact_m=0.05,
        exact_rad=math.radians(2.0),
        settle_s=SETTLE_S,
    )
