"""The control of the legs: one walking command per period, from a motion or a velocity stream.

It also makes the humanoid's part of `robot_state`, JSON-ready.
"""

import math
from typing import Any

from edgevox.core.transforms import Pose2D, turn_between
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.humanoid.environment import MujocoHumanoidEnvironment
from edgevox.robots.humanoid.motion_primitive import MotionPrimitive
from edgevox.robots.humanoid.walker import WalkerLimits
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand


def describe(
    environment: MujocoHumanoidEnvironment, motion: MotionPrimitive | None, *, walking: bool
) -> dict[str, Any]:
    """Pose and height of the pelvis (metres, radians, map frame), velocity (m/s, rad/s), and more.

    `simulation` is "physics", or "kinematic" for a robot that is moved without any forces; `gait`
    says what decides its steps, `activity` what it does.
    """
    pose, twist = environment.pose, environment.velocity
    return {
        "simulation": environment.simulation,
        "gait": environment.gait,
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "height": round(environment.height_m, 4),
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
        "activity": "fallen" if environment.fallen else "walking" if walking else "standing",
        "fallen": environment.fallen,
        "goal": _goal(motion),
    }


def _goal(motion: MotionPrimitive | None) -> dict[str, Any] | None:
    """Describe the motion: its kind, its progress (0 to 1), and the metres or degrees left."""
    if motion is None:
        return None
    progress = motion.progress()
    kind = {"m": "walk", "deg": "turn"}.get(progress.unit, "stand")
    return {"kind": kind, "progress": round(progress.part, 3), "left": round(progress.left, 3)}


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
        """Whether a velocity is asked for, or the robot may still be coming to a stand."""
        return self._stood_s < self._limits.settle_s

    @property
    def busy(self) -> bool:
        """Whether a motion is asked for, or the robot is still coming to a stand."""
        return self._mux.busy or self.walking

    def aligned(self, pose: Pose2D) -> Pose2D:
        """Return the start of a motion: this pose, with the heading that the last one wanted.

        So errors of a degree or two do not add up, and four corners make a square.
        """
        heading = self._heading_rad
        if heading is None or abs(turn_between(heading, pose.yaw_rad)) > _ALIGN_RAD:
            return pose
        return Pose2D(pose.x_m, pose.y_m, heading)

    def forget_heading(self) -> None:
        """Forget the last motion's heading: the robot was halted, or turned by another command."""
        self._heading_rad = None

    def command(self, time_s: float, pose: Pose2D) -> WalkingCommand:
        """Return the legs' command for the next period."""
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
