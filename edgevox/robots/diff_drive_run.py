"""What happens to a 2D robot from one reset to the next, step by step."""

import math
from collections import deque

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D
from edgevox.robots.battery import Battery
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, CommandMux
from edgevox.robots.engine import STEP_S, Engine, MotionState
from edgevox.robots.navigation_motion import NavigationMotion
from edgevox.robots.shapes import Point
from edgevox.robots.velocity_ramp import VelocityRamp
from edgevox.robots.world_model import World

MOST_TRAIL_POINTS = 5000
TRAIL_STEP_M = 0.05
_MOVING_M_S = 1e-3  # and rad/s
_LOOK_EVERY_STEPS = 10
"""How often furniture is looked at; a drive does so every 25 steps."""


class DiffDriveRun:
    """The engine, what the wheels do, the charge that is left, the way it took. The robot locks."""

    def __init__(self, world: World, engine: Engine, mux: CommandMux[NavigationMotion]) -> None:
        """Put the world of `engine` back where it began."""
        start = world.robot.start
        self.engine = engine
        engine.put(start, [thing.pose for thing in world.movable])
        self.ramp = VelocityRamp(world.robot)
        self._mux = mux
        self.battery = Battery(world.battery, world.battery.dock or (start.x_m, start.y_m))
        self.motion: MotionState = engine.motion()
        self.collisions = 0
        self.trail: deque[Point] = deque([(start.x_m, start.y_m)], maxlen=MOST_TRAIL_POINTS)
        self._movable: tuple[Pose2D, ...] = engine.movable_poses()
        self._steps = 0
        self._resting = False

    @property
    def busy(self) -> bool:
        """Whether something is asked, or the robot still brakes."""
        return self._mux.busy or self.ramp.velocity != STILL

    @property
    def resting(self) -> bool:
        """Whether the next step changes nothing but the time, and the charge."""
        return self._resting and not self.busy

    @property
    def moving(self) -> bool:
        """Whether the robot is not at rest."""
        twist = self.motion.twist
        return abs(twist.linear_m_s) > _MOVING_M_S or abs(twist.angular_rad_s) > _MOVING_M_S

    def step(self, time_s: float) -> None:
        """Let `engine.STEP_S` pass; `time_s` is the world's time.

        Raises `ArithmeticError` for numbers that are none, or what the engine raises: everything is
        where it was before then, at rest.
        """
        self._steps += 1
        if self.battery.empty and self.busy:
            self._mux.halt(SkillFailed(because("battery_empty")))
        try:
            self._move(time_s)
        except Exception:
            self.engine.put(self.motion.pose, self._movable)
            self.motion = self.engine.motion()
            raise
        self.battery.step(STEP_S, self.motion.pose, self.motion.twist)

    def _move(self, time_s: float) -> None:
        if self.resting:
            return  # a world in which nothing moves costs nothing but its time
        before = self.motion
        motion = self.engine.step(self.ramp.step(self._wanted(time_s)))
        if not motion.finite:
            raise ArithmeticError(f"the robot's motion became {motion}; it was put back")
        if self._steps % _LOOK_EVERY_STEPS == 0:
            movable = self.engine.movable_poses()
            if not all(pose.finite for pose in movable):
                raise ArithmeticError(f"what can be pushed is at {movable}; it was put back")
            self._movable = movable
        self.motion = motion
        self._resting = not self.busy and self.engine.still
        if motion.touching:
            self.collisions += len(motion.touching - before.touching)
        here = (motion.pose.x_m, motion.pose.y_m)
        if math.dist(here, self.trail[-1]) >= TRAIL_STEP_M:
            self.trail.append(here)

    def _wanted(self, time_s: float) -> Twist2D | None:
        self._mux.tick(time_s)
        drive = self._mux.motion
        if drive is None:
            return self._mux.velocity
        twist = drive.steer(time_s, self.motion, self._movable)
        return None if drive.done else self._mux.limit(twist)
