"""What makes a robot walk: a policy in physics, or a gait that moves joints and base outright."""

from dataclasses import dataclass
from typing import Literal, Protocol

import mujoco

from edgevox.core.transforms import Pose2D
from edgevox.robots.humanoid.floating_base import FloatingBase
from edgevox.robots.humanoid.walking_policy import WalkingCommand

PERIOD_S = 0.02
"""The world's time that passes with each step of a walker that has no policy."""


@dataclass(frozen=True, slots=True)
class WalkerLimits:
    """The fastest it really walks, and how exactly a walk can be ended.

    `coast_m` is how far from its end a walk stops, because the robot coasts; `near_m` and
    `near_rad` are the same for a few slow steps and for a turn;
    `exact_m` and `exact_rad` are how far off it may be once it stands; `settle_s` is how long it
    takes to stand. A robot whose base is moved outright has none of this.
    """

    forward_m_s: float
    left_m_s: float
    turn_rad_s: float
    slowest_m_s: float = 0.0
    slowest_rad_s: float = 0.0
    coast_m: float = 1e-6
    near_m: float = 1e-6
    near_rad: float = 1e-6
    exact_m: float = 1e-5
    exact_rad: float = 1e-5
    settle_s: float = 0.0


class Walker(Protocol):
    """Lets a robot walk, one `period_s` after the other. Not thread-safe."""

    @property
    def simulation(self) -> Literal["physics", "kinematic"]:
        """Whether forces move the robot."""

    @property
    def name(self) -> str:
        """What decides the steps."""

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
