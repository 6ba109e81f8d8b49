"""The control of the legs: one walking command per period, from a motion or a velocity stream.

`MotionPrimitive` is a skill's motion: it walks, turns or stands, and ends exactly once. `describe`
makes the humanoid's part of `robot_state`, JSON-ready.
"""

import math
from typing import Any

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D, rotate, turn_between
from edgevox.robots.command_mux import CommandMux, clamped
from edgevox.robots.humanoid.environment import MujocoHumanoidEnvironment
from edgevox.robots.humanoid.walker import WalkerLimits
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand
from edgevox.robots.motion import Motion, Progress

PATIENCE_S = 6.0
"""Seconds without progress after which it gives up."""
CORRECTIONS = 3
"""The most corrections by a few more steps, when it stands too far from its goal."""
EASE_M_S2, EASE_RAD_S2 = 0.3, 0.5
"""The deceleration before the end of a walk or a turn."""
_GAIN = 1.2
_NEARER = 0.02
_LEARN = 0.7
"""The share of the last error by which it aims further: it coasts about the same each time."""
_MOST_ASIDE_M = 0.1


class MotionPrimitive(Motion):
    """Walks `distance_m` straight on (back if negative), turns `angle_rad` to the left, or stands.

    The loop is closed on the robot's pose: it slows down before the end, comes to a stand, measures
    the error, and corrects that with a few more steps.
    """

    def __init__(
        self,
        start: Pose2D,
        limits: WalkerLimits,
        period_s: float,
        *,
        distance_m: float = 0.0,
        angle_rad: float = 0.0,
    ) -> None:
        super().__init__()
        self._start, self._limits, self._period_s = start, limits, period_s
        self._distance_m, self._angle_rad = distance_m, angle_rad
        self._yaw, self._turned = start.yaw_rad, 0.0
        self._look(start)
        self._settling = not (distance_m or angle_rad)
        self._settled_s = 0.0
        self._corrections = 0
        self._lead_m = self._lead_rad = 0.0
        self._best, self._since_best_s = math.inf, 0.0

    @property
    def moves(self) -> bool:
        """Whether it walks or turns; a stand does not."""
        return bool(self._distance_m or self._angle_rad)

    @property
    def heading_rad(self) -> float:
        """The heading at the end, if it is exact."""
        return self._start.yaw_rad + self._angle_rad

    def steer(self, pose: Pose2D) -> WalkingCommand:
        """The velocity to ask for in the next period; ends it when it is there or gives up."""
        self._look(pose)
        if self._settling:
            self._settle()
            return STAND
        if self._is_near():
            self._settling, self._settled_s = True, 0.0
            return STAND
        self._lose_patience()
        return STAND if self.done else self._walk()

    def progress(self) -> Progress:
        """Return the progress of the motion."""
        if not self.moves:
            part = 1.0 if self.done else 0.0
            return Progress(part, 0.0, "s")
        if self._distance_m:
            part = 1.0 - abs(self._ahead_m) / abs(self._distance_m)
            return Progress(min(max(part, 0.0), 1.0), self._ahead_m, "m")
        part = 1.0 - abs(self._turn_rad) / abs(self._angle_rad)
        return Progress(min(max(part, 0.0), 1.0), math.degrees(self._turn_rad), "deg")

    def _look(self, pose: Pose2D) -> None:
        """Measure the rest: metres along and across its original way, radians to the left."""
        self._turned += turn_between(self._yaw, pose.yaw_rad)
        self._yaw = pose.yaw_rad
        start = self._start
        along, left = rotate(pose.x_m - start.x_m, pose.y_m - start.y_m, -start.yaw_rad)
        self._ahead_m = self._distance_m - along
        self._aside_m = -left
        self._turn_rad = self._angle_rad - self._turned

    def _is_near(self) -> bool:
        straight = abs(self._turn_rad + self._lead_rad) < self._limits.near_rad
        if not self._distance_m:
            return straight
        there = abs(self._ahead_m + self._lead_m) < self._near_m()
        return there and (straight or not self._corrections)

    def _near_m(self) -> float:
        """Return the coasting distance.

        Longer from a walk than from the few steps of a correction.
        """
        return self._limits.near_m if self._corrections else self._limits.coast_m

    def _settle(self) -> None:
        self._settled_s += self._period_s
        if self._settled_s < self._limits.settle_s:
            return
        if not self.moves or self._is_exact() or self._corrections == CORRECTIONS:
            self.end(None)
            return
        self._corrections += 1
        self._lead_m += _LEARN * self._ahead_m
        self._lead_rad += _LEARN * self._turn_rad
        self._settling, self._best = False, math.inf

    def _is_exact(self) -> bool:
        limits = self._limits
        there = not self._distance_m or abs(self._ahead_m) < limits.exact_m
        return there and abs(self._turn_rad) < limits.exact_rad

    def _lose_patience(self) -> None:
        self._since_best_s += self._period_s
        left = abs(self._ahead_m if self._distance_m else self._turn_rad)
        if left < self._best - _NEARER:
            self._best, self._since_best_s = left, 0.0
        if self._since_best_s > PATIENCE_S:
            self.end(SkillFailed(because("no_further")))

    def _walk(self) -> WalkingCommand:
        """Along the way, back onto it from aside, and straight ahead; a turn stays on the spot."""
        limits = self._limits
        left_m, left_rad = self._ahead_m + self._lead_m, self._turn_rad + self._lead_rad
        along = (
            self._eased(left_m, limits.forward_m_s, limits.slowest_m_s, EASE_M_S2)
            if self._distance_m
            else clamped(_GAIN * left_m, _MOST_ASIDE_M)
        )
        across = clamped(_GAIN * self._aside_m, _MOST_ASIDE_M)
        turn = (
            self._eased(left_rad, limits.turn_rad_s, limits.slowest_rad_s, EASE_RAD_S2)
            if self._angle_rad
            else clamped(_GAIN * left_rad, limits.turn_rad_s)
        )
        forward, left = rotate(along, across, self._start.yaw_rad - self._yaw)
        return WalkingCommand(forward, left, turn)

    def _eased(self, left: float, most: float, slowest: float, ease: float) -> float:
        """A speed towards what is left: as fast as it may, slower before the end, never past it."""
        speed = min(math.sqrt(2 * ease * abs(left)), most)
        return math.copysign(min(max(speed, slowest), abs(left) / self._period_s), left)


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
