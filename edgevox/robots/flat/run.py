"""A run of a 2D robot, from one reset to the next, step by step.

`VelocityRamp` limits the change of the wheels' speed, except for braking.

`Battery` loses charge by what the robot does, and gains it on the dock. It draws `idle_w` always,
and for actual motion `linear_w_per_m_s` for each metre per second and `angular_w_per_rad_s` for
each radian per second. Within `DOCK_REACH_M` of the dock, standing, it charges with `charge_w`.
"""

import math
from collections import deque

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, CommandMux, clamped
from edgevox.robots.flat.drive import FlatMotion
from edgevox.robots.flat.engine import STEP_S, Engine, MotionState
from edgevox.robots.shapes import Point
from edgevox.robots.world.model import BatterySpec, RobotSpec, World


class VelocityRamp:
    """`velocity` is what the wheels are asked for now. Not thread-safe; the body locks."""

    def __init__(self, limits: RobotSpec) -> None:
        self.velocity = STILL
        self._linear_m_s = limits.max_linear_m_s2 * STEP_S
        self._angular_rad_s = limits.max_angular_rad_s2 * STEP_S

    def step(self, wanted: Twist2D | None) -> Twist2D:
        """The velocity of the next step; it brakes as hard as it can where nothing is wanted."""
        if wanted is None:
            self.brake()
        else:
            now = self.velocity
            self.velocity = Twist2D(
                _toward(now.linear_m_s, wanted.linear_m_s, self._linear_m_s),
                _toward(now.angular_rad_s, wanted.angular_rad_s, self._angular_rad_s),
            )
        return self.velocity

    def brake(self) -> None:
        """Ask for a stand at once."""
        self.velocity = STILL


def _toward(now: float, wanted: float, most: float) -> float:
    return wanted if -most <= wanted - now <= most else now + clamped(wanted - now, most)


DOCK_REACH_M = 0.3
_STANDING_M_S = 0.02


class Battery:
    """Charge of one robot."""

    def __init__(self, spec: BatterySpec, dock: Point) -> None:
        self._spec = spec
        self._dock = dock
        self._left_wh = spec.capacity_wh

    @property
    def charge(self) -> float:
        """The charge, 0 to 1."""
        return self._left_wh / self._spec.capacity_wh

    @property
    def empty(self) -> bool:
        return self._left_wh <= 0.0

    def lasts_s(self, speed_m_s: float) -> float:
        """Seconds for which the charge lasts at this speed."""
        power_w = self._spec.idle_w + self._spec.linear_w_per_m_s * speed_m_s
        return 3600.0 * self._left_wh / power_w if power_w > 0.0 else math.inf

    def step(self, seconds: float, pose: Pose2D, twist: Twist2D) -> None:
        """Account for this much time at this place with this motion."""
        spec = self._spec
        speed, turning = abs(twist.linear_m_s), abs(twist.angular_rad_s)
        power_w = spec.idle_w + spec.linear_w_per_m_s * speed + spec.angular_w_per_rad_s * turning
        if speed < _STANDING_M_S and math.dist((pose.x_m, pose.y_m), self._dock) <= DOCK_REACH_M:
            power_w -= spec.charge_w
        left = self._left_wh - power_w * seconds / 3600.0
        self._left_wh = min(max(left, 0.0), spec.capacity_wh)


MOST_TRAIL_POINTS = 5000
TRAIL_STEP_M = 0.05
_MOVING_M_S = 1e-3  # and rad/s
_LOOK_EVERY_STEPS = 10
"""Steps between two looks at the furniture; a drive looks every 25 steps."""


class DiffDriveRun:
    """The engine, what the wheels do, the charge that is left, the way it took. The robot locks."""

    def __init__(self, world: World, engine: Engine, mux: CommandMux[FlatMotion]) -> None:
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
        """Whether a motion is asked for, or the robot still brakes."""
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
