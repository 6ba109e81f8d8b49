"""Walking policies: what one sees, what it answers, and how to bring one's own.

A policy is called once every `period_s` of simulated time with an `Observation` and answers with a
target angle for each of its joints, which position servos of the given stiffness and damping follow
until the next call. Any object with the three members of `WalkingPolicy` will do; a bare function
becomes one with `FunctionPolicy`:

    def keep_still(seen: Observation) -> NDArray[np.float64]:
        return plan.stand_rad

    environment.set_walking_policy(FunctionPolicy(plan, keep_still))

What a policy remembers from call to call (its last action, the phase of its gait) is its own
business; `reset` makes it forget.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class WalkingCommand:
    """The velocity to walk at, in the robot's own frame: m/s ahead, m/s to the left, rad/s left."""

    forward_m_s: float = 0.0
    left_m_s: float = 0.0
    turn_rad_s: float = 0.0

    @property
    def stands(self) -> bool:
        """Whether no motion is asked for at all."""
        return not (self.forward_m_s or self.left_m_s or self.turn_rad_s)


STAND = WalkingCommand()


@dataclass(frozen=True, slots=True)
class Observation:
    """What a policy sees, all of it measurable on a real robot.

    `turning_rad_s` (3,) is the pelvis's angular velocity and `gravity` (3,) the unit vector that
    points down, both in the pelvis's own axes; `angles_rad` and `speeds_rad_s` (n,) are the joints
    in the policy's order.
    """

    command: WalkingCommand
    turning_rad_s: Vector
    gravity: Vector
    angles_rad: Vector
    speeds_rad_s: Vector


@dataclass(frozen=True)
class WalkingPlan:
    """What the robot must be like for a policy: its joints, their servos, the rates.

    `joints` are names of the MJCF's hinges, in the order of all vectors (n,): the angles of a calm
    stand, stiffness (N m/rad), damping (N m s/rad) and rotor inertia (kg m^2). `period_s` is a
    whole multiple of `timestep_s`. The limits are the fastest commands that keep it on its feet,
    and `follows` is how much of a commanded speed (ahead, left, turning) it really walks at.
    """

    joints: tuple[str, ...]
    stand_rad: Vector
    stiffness: Vector
    damping: Vector
    armature: Vector
    period_s: float = 0.02
    timestep_s: float = 0.005
    max_forward_m_s: float = 1.0
    max_left_m_s: float = 0.5
    max_turn_rad_s: float = 1.0
    follows: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        wanted = (len(self.joints),)
        for field in ("stand_rad", "stiffness", "damping", "armature"):
            shape = getattr(self, field).shape
            if shape != wanted:
                raise InvalidValue(field, shape, f"a vector of shape {wanted}, one for each joint")
        if self.timestep_s <= 0 or self.steps < 1 or not self._whole():
            expected = f"a whole multiple of timestep_s, which is {self.timestep_s}"
            raise InvalidValue("period_s", self.period_s, expected)

    @property
    def steps(self) -> int:
        """Physics steps for each call of the policy."""
        return round(self.period_s / self.timestep_s)

    def _whole(self) -> bool:
        return abs(self.steps * self.timestep_s - self.period_s) < 1e-9


class WalkingPolicy(Protocol):
    """Decides where the joints shall go."""

    @property
    def name(self) -> str:
        """What `robot_state` calls it."""

    @property
    def plan(self) -> WalkingPlan:
        """What it needs; it stays so."""

    def reset(self) -> None:
        """The robot was put somewhere else: forget what was."""

    def act(self, seen: Observation) -> Vector:
        """Target angles (n,) in radians, in the plan's order of joints."""


class FunctionPolicy:
    """A policy that remembers nothing: one function."""

    def __init__(
        self,
        plan: WalkingPlan,
        function: Callable[[Observation], Vector],
        name: str = "function",
    ) -> None:
        self.name, self.plan, self._function = name, plan, function

    def reset(self) -> None:
        """There is nothing to forget."""

    def act(self, seen: Observation) -> Vector:
        return self._function(seen)
