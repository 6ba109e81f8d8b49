"""`robot-apartment`: a robot on two wheels in a 2D apartment, simulated with pymunk."""

import logging
import math
import threading
from collections import deque
from collections.abc import Mapping
from types import MappingProxyType, TracebackType
from typing import Any

from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.robots.battery import Battery
from edgevox.robots.capabilities import LidarScan, Pose2D, Report, Twist2D
from edgevox.robots.drive import Drive
from edgevox.robots.lidar import Lidar
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.physics import STEP_S, Physics
from edgevox.robots.pilot import Pilot
from edgevox.robots.planner import Planner
from edgevox.robots.shapes import Point
from edgevox.robots.snapshot import describe_goal, describe_motion
from edgevox.robots.stepper import Stepper
from edgevox.robots.text_map import draw
from edgevox.robots.world import load_world
from edgevox.robots.world_model import World

log = logging.getLogger(__name__)

REPORT_EVERY_S = 0.2
TRAIL_STEP_M = 0.05
_MOVING_M_S = 1e-3
_LOOK_EVERY_STEPS = 5


class ApartmentRobot:
    """A body with a pose, a lidar, a battery, rooms, and the sense to drive somewhere by itself.

    `speed` is how many seconds pass in its world each second, 1 for real time. With None, for
    tests, they pass as fast as they can while it drives or comes to rest; otherwise, also while
    somebody sends velocities, only as far as `advance` asks.
    Every method may be called from any thread. A cancelled or halted robot is asked for zero
    velocity before the call returns and stands within 0.1 s of its own time.
    """

    name = "robot-apartment"

    def __init__(
        self, world: World | None = None, *, speed: float | None = 1.0, clock: Clock | None = None
    ) -> None:
        self.world = world or load_world()
        self.max_linear_m_s = self.world.robot.max_linear_m_s
        self.max_angular_rad_s = self.world.robot.max_angular_rad_s
        self._changed = threading.Condition(threading.Lock())
        self._planner = Planner(self.world)
        self._lidar = Lidar(self.world)
        self._places = MappingProxyType({room.name: room.goal for room in self.world.rooms})
        self._ticks = 0
        self._wanted_ticks = 0
        self._build()
        hints = {room.name: room.hints for room in self.world.rooms}
        aliases = {said: room.name for room in self.world.rooms for said in room.aliases}
        self._skills = navigation_skills(self, hints, aliases)
        self._stepper = Stepper(
            self._step, period_s=STEP_S, speed=speed, clock=clock, name=f"{self.name} world"
        )

    def __enter__(self) -> "ApartmentRobot":
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        return self._ticks * STEP_S

    @property
    def places(self) -> Mapping[str, tuple[float, float]]:
        return self._places

    @property
    def real_time_factor(self) -> float:
        """Seconds that pass in the world each second."""
        return self._stepper.real_time_factor

    def start(self) -> None:
        self._stepper.start()

    def close(self) -> None:
        """Stop moving and join the thread. A drive that runs ends as cancelled."""
        self.halt("the robot was switched off")
        self._stepper.close()

    def reset(self) -> None:
        """Everything back where it started, with a full battery; time goes on."""
        with self._changed:
            self._pilot.stand(Cancelled("the world was reset"))
            self._build()

    def pose(self) -> Pose2D:
        with self._changed:
            return self._motion.pose

    def velocity(self) -> Twist2D:
        with self._changed:
            return self._motion.twist

    def battery(self) -> float:
        with self._changed:
            return self._battery.charge

    def trail(self) -> tuple[Point, ...]:
        """Where the robot has been since the start or a reset, at most the last 5000 points."""
        with self._changed:
            return tuple(self._trail)

    def movable_poses(self) -> tuple[Pose2D, ...]:
        """Where the things that can be pushed are, in the world's order."""
        with self._changed:
            return self._physics.movable_poses()

    def scan(self) -> LidarScan:
        with self._changed:
            time_s, pose = self.time_s, self._motion.pose
            movable = self._physics.movable_poses()
        return self._lidar.scan(time_s, pose, movable)

    def place_at(self, x_m: float, y_m: float) -> str | None:
        room = self.world.room_at(x_m, y_m)
        return room.name if room else None

    def set_velocity(self, twist: Twist2D) -> None:
        checked = Twist2D(
            _finite("linear_m_s", twist.linear_m_s), _finite("angular_rad_s", twist.angular_rad_s)
        )
        with self._changed:
            self._pilot.take(checked, self.time_s)
        self._stepper.wake()

    def halt(self, reason: str) -> bool:
        with self._changed:
            moved = self._pilot.busy or self._moving()
            self._pilot.stand(Cancelled(reason))
        self._stepper.wake()
        return moved

    def drive_to(self, x_m: float, y_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until there. Raises `SkillFailed` with a reason, `Cancelled` if it was ended.

        A halt, a velocity or another drive ends it. One that is refused disturbs nothing.
        """
        goal = (_finite("x", x_m), _finite("y", y_m))
        token.check()
        drive = self._begin(goal)
        forget = token.on_cancel(lambda: self._end(drive, Cancelled(token.reason)))
        try:
            while not drive.done.wait(REPORT_EVERY_S):
                self._report(drive, report)
        finally:
            forget()
        self._report(drive, report)
        if drive.error is not None:
            raise drive.error

    def state(self) -> Mapping[str, Any]:
        with self._changed:
            time_s, motion, drive = self.time_s, self._motion, self._pilot.drive
            charge, collisions = self._battery.charge, self._collisions
            progress = drive.progress() if drive else None
        room = self.place_at(motion.pose.x_m, motion.pose.y_m)
        return {
            "name": self.name,
            "time": round(time_s, 3),
            **describe_motion(motion),
            "room": room,
            "battery": round(charge, 4),
            "goal": describe_goal(progress),
            "touching": sorted(motion.touching),
            "collisions": collisions,
        }

    def draw_map(self, columns: int) -> str:
        with self._changed:
            pose, movable = self._motion.pose, self._physics.movable_poses()
            drive = self._pilot.drive
            way = drive.way() if drive else ()
        return draw(self.world, pose, movable, way, columns)

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed."""
        with self._changed:
            until = self._ticks + max(1, round(seconds / STEP_S))
            self._wanted_ticks = max(self._wanted_ticks, until)
            self._stepper.wake()
            self._changed.wait_for(lambda: self._ticks >= until or not self._stepper.running)

    def _build(self) -> None:
        spec = self.world.robot
        dock = self.world.battery.dock or (spec.start.x_m, spec.start.y_m)
        self._physics = Physics(self.world)
        self._pilot = Pilot(spec)
        self._battery = Battery(self.world.battery, dock)
        self._motion = self._physics.motion()
        self._movable = self._physics.movable_poses()
        self._trail = deque([(spec.start.x_m, spec.start.y_m)], maxlen=5000)
        self._collisions = 0
        self._resting = False

    def _begin(self, goal: Point) -> Drive:
        with self._changed:
            if not self._stepper.running:
                raise SkillFailed("I am switched off.")
            if self._battery.empty:
                raise SkillFailed("My battery is empty.")
            drive = Drive(
                goal,
                self._planner,
                self.world.robot,
                time_s=self.time_s,
                pose=self._motion.pose,
                movable=self._physics.movable_poses(),
            )
            self._pilot.follow(drive)
        self._stepper.wake()
        return drive

    def _end(self, drive: Drive, reason: BaseException) -> None:
        with self._changed:
            if self._pilot.drive is drive:
                self._pilot.stand(reason)

    def _report(self, drive: Drive, report: Report) -> None:
        with self._changed:
            progress, pose = drive.progress(), self._motion.pose
        report(
            progress=round(progress.progress, 3),
            distance_m=round(progress.distance_m, 3),
            x=round(pose.x_m, 3),
            y=round(pose.y_m, 3),
        )

    def _step(self) -> bool:
        """One step of the world, on the stepper's thread. True if more is to come."""
        with self._changed:
            self._ticks += 1
            if self._battery.empty and self._pilot.busy:
                self._pilot.stand(SkillFailed("My battery is empty."))
            if self._ticks % _LOOK_EVERY_STEPS == 0:
                self._movable = self._physics.movable_poses()
            self._move()
            self._battery.step(STEP_S, self._motion.pose, self._motion.twist)
            self._changed.notify_all()
            going_on = (self._pilot.busy or self._moving()) and not self._pilot.steered
            return going_on or self._ticks < self._wanted_ticks

    def _move(self) -> None:
        if self._resting and not self._pilot.busy:
            return  # a world in which nothing moves costs nothing but its time
        before = self._motion
        command = self._pilot.command(self.time_s, before, self._movable)
        motion = self._physics.step(command)
        if not motion.finite:
            self._physics = Physics(self.world, before.pose, self._movable)
            self._motion = self._physics.motion()
            raise ArithmeticError(f"the robot's motion became {motion}; it was put back")
        self._motion = motion
        self._resting = not self._pilot.busy and self._physics.still
        self._collisions += len(motion.touching - before.touching)
        here = (motion.pose.x_m, motion.pose.y_m)
        if math.dist(here, self._trail[-1]) >= TRAIL_STEP_M:
            self._trail.append(here)

    def _moving(self) -> bool:
        twist = self._motion.twist
        return abs(twist.linear_m_s) > _MOVING_M_S or abs(twist.angular_rad_s) > _MOVING_M_S


def _finite(field: str, value: float) -> float:
    if not math.isfinite(value):
        raise InvalidValue(field, value, "a finite number")
    return float(value)
