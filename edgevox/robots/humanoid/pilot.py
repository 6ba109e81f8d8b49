"""Decides what the legs are asked for: a manoeuvre, a stream of velocities, or to stand.

The latest request wins and ends the one before.
"""

import math

from edgevox.core.cancel import Cancelled
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid.manoeuvre import Manoeuvre
from edgevox.robots.humanoid.policy import STAND, WalkingCommand
from edgevox.robots.humanoid.walker import Limits

log = get_logger(__name__)

WATCHDOG_S = 0.5
"""A stream of velocities that is silent for so long has stopped."""
_ALIGN_RAD = math.radians(5.0)


class Pilot:
    """Not thread-safe; the body locks."""

    def __init__(self, limits: Limits, period_s: float) -> None:
        self._limits, self._period_s = limits, period_s
        self._stream: WalkingCommand | None = None
        self._stream_until_s = 0.0
        self._manoeuvre: Manoeuvre | None = None
        self._stood_s = limits.settle_s
        self._heading_rad: float | None = None
        self.watchdog_halts = 0
        """Streams that stopped though they had not asked for a stand."""

    @property
    def manoeuvre(self) -> Manoeuvre | None:
        """The one that runs."""
        return self._manoeuvre

    @property
    def walking(self) -> bool:
        """Whether any velocity was asked for, or the robot may still be coming to a stand."""
        return self._stood_s < self._limits.settle_s

    @property
    def busy(self) -> bool:
        """Whether something is asked, or the robot is still coming to a stand."""
        return self._manoeuvre is not None or self._stream is not None or self.walking

    @property
    def steered(self) -> bool:
        """Whether somebody sends velocities."""
        return self._stream is not None

    def aligned(self, pose: Pose2D) -> Pose2D:
        """Where a manoeuvre begins: there, looking where the one before should have ended.

        So the degree or two that each is off do not add up, and four corners make a square.
        """
        heading = self._heading_rad
        if heading is None or abs(math.remainder(pose.yaw_rad - heading, math.tau)) > _ALIGN_RAD:
            return pose
        return Pose2D(pose.x_m, pose.y_m, heading)

    def follow(self, manoeuvre: Manoeuvre) -> None:
        """Do this from now on."""
        self._end(Cancelled("a new goal came"))
        self._stream, self._manoeuvre = None, manoeuvre

    def take(self, twist: Twist2D, time_s: float) -> None:
        """Follow this velocity, within the limits, for as long as the watchdog allows."""
        self._end(Cancelled("somebody else steers"))
        self._heading_rad = None
        self._stream = WalkingCommand(
            _within(twist.linear_m_s, self._limits.forward_m_s),
            0.0,
            _within(twist.angular_rad_s, self._limits.turn_rad_s),
        )
        self._stream_until_s = time_s + WATCHDOG_S

    def stand(self, reason: BaseException) -> None:
        """Ask for nothing any more; a manoeuvre ends with this reason."""
        self._end(reason)
        self._stream = self._heading_rad = None

    def command(self, time_s: float, pose: Pose2D) -> WalkingCommand:
        """What the legs shall do in the next period."""
        if self._stream is not None and time_s >= self._stream_until_s:
            if not self._stream.stands:
                self.watchdog_halts += 1
                log.warning("watchdog_halted", silent_s=WATCHDOG_S)
            self._stream = None
        wanted = self._wanted(pose)
        self._stood_s = self._stood_s + self._period_s if wanted.stands else 0.0
        return wanted

    def _wanted(self, pose: Pose2D) -> WalkingCommand:
        if self._manoeuvre is None:
            return self._stream or STAND
        wanted = self._manoeuvre.steer(pose)
        if self._manoeuvre.done.is_set():
            self._heading_rad = self._manoeuvre.heading_rad
            self._manoeuvre = None
        return wanted

    def _end(self, reason: BaseException) -> None:
        if self._manoeuvre is not None:
            self._manoeuvre.end(reason)
            self._manoeuvre = None


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)
