"""Walking policies: their observation, their answer, and the interface for one of your own."""

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
    """A policy's observation, all of it measurable on a real robot."""

    command: WalkingCommand
    turning_rad_s: Vector
    """The pelvis's angular velocity, (3,), in the pelvis's own axes."""
    gravity: Vector
    """The unit vector that points down, (3,), in the pelvis's own axes."""
    angles_rad: Vector
    """The joints' angles, (n,), in the policy's order."""
    speeds_rad_s: Vector
    """The joints' speeds, (n,), in the policy's order."""


@dataclass(frozen=True)
class WalkingPlan:
    """A policy's demands on the robot: its joints, their servos, the rates."""

    joints: tuple[str, ...]
    """Names of the MJCF's hinges, in the order of all vectors (n,)."""
    stand_rad: Vector
    """The angles of a calm stand."""
    stiffness: Vector
    """N m/rad."""
    damping: Vector
    """N m s/rad."""
    armature: Vector
    """Rotor inertia, kg m^2."""
    period_s: float = 0.02
    """Between two calls of the policy; a whole multiple of `timestep_s`."""
    timestep_s: float = 0.005
    """Of the physics."""
    max_forward_m_s: float = 1.0
    """The fastest command that keeps it on its feet; likewise the next two."""
    max_left_m_s: float = 0.5
    max_turn_rad_s: float = 1.0
    follows: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """The share of a commanded speed (ahead, left, turning) that it really walks at."""

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
        """Its name in `robot_state`."""

    @property
    def plan(self) -> WalkingPlan:
        """Its demands on the robot; they do not change."""

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
        """Do nothing: a function has no state."""

    def act(self, seen: Observation) -> Vector:
        return self._function(seen)
