"""What the legs are asked for, period by period, by whoever may move the robot."""

import math

from edgevox.core.transforms import Pose2D, turn_between
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.humanoid.motion_primitive import MotionPrimitive
from edgevox.robots.humanoid.walker import WalkerLimits
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand

_ALIGN_RAD = math.radians(5.0)


class WalkControl:
    """Not thread-safe; the body locks."""

    def __init__(
        self, mux: CommandMux[MotionPrimitive], limits: WalkerLimits, period_s: float
    ) -> None:
        self._mux, self._limits, self._period_s = mux, limits, period_s
        self._stood_s = limits.settle_s
        self._heading_rad: float | None = None

    @property
    def walking(self) -> bool:
        """Whether any velocity was asked for, or the robot may still be coming to a stand."""
        return self._stood_s < self._limits.settle_s

    @property
    def busy(self) -> bool:
        """Whether something is asked, or the robot is still coming to a stand."""
        return self._mux.busy or self.walking

    def aligned(self, pose: Pose2D) -> Pose2D:
        """Where a motion begins: there, looking where the one before should have ended.

        So the degree or two that each is off do not add up, and four corners make a square.
        """
        heading = self._heading_rad
        if heading is None or abs(turn_between(heading, pose.yaw_rad)) > _ALIGN_RAD:
            return pose
        return Pose2D(pose.x_m, pose.y_m, heading)

    def forget_heading(self) -> None:
        """The robot looks where it looks: it was halted, or somebody else turned it."""
        self._heading_rad = None

    def command(self, time_s: float, pose: Pose2D) -> WalkingCommand:
        """What the legs shall do in the next period."""
        self._mux.tick(time_s)
        wanted = self._wanted(pose)
        self._stood_s = self._stood_s + self._period_s if wanted.stands else 0.0
        return wanted

    def _wanted(self, pose: Pose2D) -> WalkingCommand:
        motion, velocity = self._mux.motion, self._mux.velocity
        if velocity is not None:
            return WalkingCommand(velocity.linear_m_s, 0.0, velocity.angular_rad_s)
        if motion is None:
            return STAND
        wanted = motion.steer(pose)
        if motion.done:
            self._heading_rad = motion.heading_rad
        return wanted
