"""Steering a body by velocities, whoever sends them: as the interlock and the policy permit."""

from collections.abc import Callable
from typing import Protocol

from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import finite
from edgevox.core.interlock import Interlock
from edgevox.robots.capabilities import Body, TakesVelocity, Twist2D

Permit = Callable[[float, float], tuple[float, float]]
"""What of a velocity, m/s and rad/s, may be followed. Raises `EdgeVoxError` where none of it."""


class Steerable(Body, TakesVelocity, Protocol):
    """A body that follows velocities."""


class Steering:
    """Hands velocities to a body, as far as the `interlock` and the policy's `permit` let them."""

    def __init__(self, body: Steerable, interlock: Interlock, permit: Permit) -> None:
        self._body, self._interlock, self._permit = body, interlock, permit

    def steer(self, linear_m_s: float, angular_rad_s: float) -> None:
        """Follow this velocity until the body's watchdog ends it. A stand is never refused.

        Raises `SkillFailed` while motion is forbidden, `InvalidValue` for what is not finite, and
        what `permit` raises.
        """
        linear = finite("linear_m_s", linear_m_s)
        angular = finite("angular_rad_s", angular_rad_s)
        moves = bool(linear or angular)
        if moves and (held := self._interlock.reason):
            raise SkillFailed(held)
        self._body.set_velocity(Twist2D(*self._permit(linear, angular)))
        if moves and (held := self._interlock.reason):  # since it was asked above
            self._body.halt(str(held))
            raise SkillFailed(held)
