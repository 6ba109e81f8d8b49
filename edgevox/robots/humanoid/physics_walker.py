"""A walker in physics: a policy moves position servos, MuJoCo does the rest."""

import math
from typing import Literal

import mujoco
import numpy as np

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.humanoid.walker import FloatingBase, WalkerLimits
from edgevox.robots.humanoid.walking_policy import (
    STAND,
    Observation,
    WalkingCommand,
    WalkingPlan,
    WalkingPolicy,
)

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
                _within(wanted.forward_m_s / forward, plan.max_forward_m_s),
                _within(wanted.left_m_s / left, plan.max_left_m_s),
                _within(wanted.turn_rad_s / turn, plan.max_turn_rad_s),
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


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)
