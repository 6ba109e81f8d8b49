"""The limits of motion: the edges of a world, and the filter for streamed velocities.

`Bounds` lets a goal outside the world be refused before anything moves. `Steering` passes
velocities to a body as far as the interlock and the policy permit.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import finite
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock, StreamStopped
from edgevox.robots.capabilities import Body, TakesVelocity, Twist2D
from edgevox.robots.command_mux import WATCHDOG_S

log = get_logger(__name__)


Permit = Callable[[float, float], tuple[float, float]]
"""Returns the permitted part of a velocity, m/s and rad/s. Raises `EdgeVoxError` if none is."""


class Steerable(Body, TakesVelocity, Protocol):
    """A body that follows velocities."""


class Steering:
    """Passes one velocity stream to a body, as far as interlock and policy permit.

    A stop ends the stream: it counts again after `WATCHDOG_S` without a moving velocity, that is
    once the sender has let go and starts again. Zero velocity is always accepted. `permit` is the
    policy's.
    """

    def __init__(
        self, body: Steerable, interlock: Interlock, permit: Permit, clock: Clock | None = None
    ) -> None:
        self._body, self._interlock, self._permit = body, interlock, permit
        self._clock = clock or SystemClock()
        self._mark = self._ended = interlock.mark
        self._moved_s = float("-inf")

    def steer(self, linear_m_s: float, angular_rad_s: float, mark: int | None = None) -> None:
        """Follow this velocity until the body's watchdog ends it. A stand is never refused.

        `mark` is the interlock's when it was received, now by default. Raises `StreamStopped` where
        a stop has ended the stream, `SkillFailed` while motion is forbidden, `InvalidValue` for
        what is not finite, and what `permit` raises.
        """
        linear = finite("linear_m_s", linear_m_s)
        angular = finite("angular_rad_s", angular_rad_s)
        mark = self._interlock.mark if mark is None else mark
        if not (linear or angular):
            self._body.set_velocity(Twist2D(*self._permit(linear, angular)))
            return
        begins = self._clock.now() - self._moved_s >= WATCHDOG_S
        self._moved_s = self._clock.now()
        self._mark = mark if begins else min(mark, self._mark)
        self._check()
        self._body.set_velocity(Twist2D(*self._permit(linear, angular)))
        if held := self._interlock.refusal(self._mark):  # since it was asked above
            self._body.halt(str(held))
            self._check()

    def let_go(self) -> None:
        """Note that the sender has let go: the next velocity starts a new stream."""
        self._moved_s = float("-inf")

    def _check(self) -> None:
        """Raise where this stream may not move the body."""
        if held := self._interlock.reason:
            raise SkillFailed(held)
        if self._interlock.refusal(self._mark):
            if self._ended != self._mark:
                self._ended = self._mark
                self._interlock.streams_ended += 1
                log.warning("stream_ended_by_a_stop", pause_s=WATCHDOG_S)
            raise StreamStopped(because("stream_stopped"))


@dataclass(frozen=True, slots=True)
class Bounds:
    """A named rectangle of the map frame, edges included. Metres."""

    name: str
    x_min_m: float
    x_max_m: float
    y_min_m: float
    y_max_m: float

    @classmethod
    def around(cls, name: str, furthest_m: float) -> "Bounds":
        """Make bounds for a world with unknown edges: this far from the map's origin."""
        return cls(name, -furthest_m, furthest_m, -furthest_m, furthest_m)

    def check(self, x_m: float, y_m: float) -> None:
        """Raise `SkillFailed` with the reason, fit for being said, if a point is not within."""
        if self.x_min_m <= x_m <= self.x_max_m and self.y_min_m <= y_m <= self.y_max_m:
            return
        edges = ("x_min", "x_max", "y_min", "y_max")
        metres = (self.x_min_m, self.x_max_m, self.y_min_m, self.y_max_m)
        values = {name: f"{value:g}" for name, value in zip(edges, metres, strict=True)}
        raise SkillFailed(because("outside", place=self.name.replace("_", " "), **values))
