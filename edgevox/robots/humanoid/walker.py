"""The interface of a walker: a policy in physics, or a gait that sets joints and base."""

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
