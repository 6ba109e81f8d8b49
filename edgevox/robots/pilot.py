"""Decides what the wheels are asked for: a drive, a stream of velocities, or to stand.

The latest request wins and ends the one before. Changes of speed keep the robot's limits; when
nothing is asked, because of a halt, a cancel or a stream that stopped, it brakes as hard as it can.
"""

from collections.abc import Sequence

from edgevox.core.cancel import Cancelled
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.drive import Drive
from edgevox.robots.engine import STEP_S, Motion
from edgevox.robots.world_model import RobotSpec

log = get_logger(__name__)

WATCHDOG_S = 0.5
"""A stream of velocities that is silent for so long has stopped."""
_STILL = Twist2D(0.0, 0.0)


class Pilot:
    """Not thread-safe; the body locks."""

    def __init__(self, limits: RobotSpec) -> None:
        self._limits = limits
        self._stream: Twist2D | None = None
        self._stream_until_s = 0.0
        self._drive: Drive | None = None
        self._command = _STILL
        self.watchdog_halts = 0
        """Streams that stopped though they had not asked for a stand."""

    @property
    def drive(self) -> Drive | None:
        """The drive that runs."""
        return self._drive

    @property
    def busy(self) -> bool:
        """Whether something is asked, or the robot still brakes."""
        return self._drive is not None or self._stream is not None or self._command != _STILL

    @property
    def steered(self) -> bool:
        """Whether somebody sends velocities."""
        return self._stream is not None

    def follow(self, drive: Drive) -> None:
        """Drive from now on."""
        self.stand(Cancelled("a new goal came"))
        self._drive = drive

    def take(self, twist: Twist2D, time_s: float) -> None:
        """Follow this velocity, within the limits, for as long as the watchdog allows."""
        self._end_drive(Cancelled("somebody else steers"))
        limits = self._limits
        self._stream = Twist2D(
            _clamped(twist.linear_m_s, limits.max_linear_m_s),
            _clamped(twist.angular_rad_s, limits.max_angular_rad_s),
        )
        self._stream_until_s = time_s + WATCHDOG_S

    def stand(self, reason: BaseException) -> None:
        """Ask for nothing any more; a drive ends with this reason."""
        self._end_drive(reason)
        self._stream = None
        self._command = _STILL

    def command(self, time_s: float, motion: Motion, movable: Sequence[Pose2D]) -> Twist2D:
        """What the wheels shall do in the next step."""
        if self._stream is not None and time_s >= self._stream_until_s:
            if self._stream != _STILL:
                self.watchdog_halts += 1
                log.warning("watchdog_halted", silent_s=WATCHDOG_S)
            self._stream = None
        wanted = self._wanted(time_s, motion, movable)
        limits = self._limits
        if wanted is None:
            self._command = _STILL
            return self._command
        self._command = Twist2D(
            _toward(self._command.linear_m_s, wanted.linear_m_s, limits.max_linear_m_s2 * STEP_S),
            _toward(
                self._command.angular_rad_s,
                wanted.angular_rad_s,
                limits.max_angular_rad_s2 * STEP_S,
            ),
        )
        return self._command

    def _wanted(self, time_s: float, motion: Motion, movable: Sequence[Pose2D]) -> Twist2D | None:
        if self._drive is None:
            return self._stream
        twist = self._drive.steer(time_s, motion, movable)
        if not self._drive.done.is_set():
            return twist
        self._drive = None
        return None

    def _end_drive(self, reason: BaseException) -> None:
        if self._drive is not None:
            self._drive.end(reason)
            self._drive = None


def _clamped(value: float, most: float) -> float:
    return min(max(value, -most), most)


def _toward(now: float, wanted: float, most: float) -> float:
    return now + _clamped(wanted - now, most)
