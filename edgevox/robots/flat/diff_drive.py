"""A robot on two wheels in a flat world: what both 2D bodies are, whatever simulates them.

The parts of `robot_state`, JSON-ready.
"""

import math
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import OneOf, Skill, SkillFailed
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.errors import finite
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Report, SpeedLimit, Twist2D
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.flat.drive import FlatMotion, NavigationMotion, RelativeFlatMotion
from edgevox.robots.flat.engine import STEP_S, Engine, MotionState
from edgevox.robots.flat.planner import PathPlanner
from edgevox.robots.flat.run import DiffDriveRun
from edgevox.robots.flat.text_map import draw
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.relative_motion import Course, StraightCourse, TurnCourse
from edgevox.robots.relative_skills import driving_skills, where
from edgevox.robots.shapes import Point
from edgevox.robots.sim_loop import BROKE, SimLoop, SimulatedBody, SteppedBySimLoop
from edgevox.robots.world.model import Room, World

if TYPE_CHECKING:
    from edgevox.robots.flat.picture import Painter


def describe_motion(motion: MotionState) -> dict[str, Any]:
    """Pose (metres, radians, map frame) and velocity (m/s, rad/s, body frame)."""
    pose, twist = motion.pose, motion.twist
    return {
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
    }


def describe_goal(drive: FlatMotion | None) -> dict[str, float] | None:
    """Describe a motion: its goal, its progress (0 to 1), and the metres left; None without one."""
    if drive is None:
        return None
    progress = drive.progress()
    return {
        "x": round(drive.goal[0], 3),
        "y": round(drive.goal[1], 3),
        "progress": round(progress.part, 3),
        "distance": round(progress.left, 3) if progress.unit == "m" else 0.0,
    }


_PICTURE_PX = 800
_TRAIL_SHOWN = 400  # points of 0.05 m


class DiffDriveRobot(SteppedBySimLoop, SimulatedBody):
    """A robot on two wheels with a pose, a lidar, a battery and rooms, which drives by itself.

    Args:
        name: The robot's name.
        world: The world that it drives in.
        engine: The simulator.
        speed: Seconds of its world per second: 1 is real time. None, for tests, is as fast as
            possible while it drives or comes to rest, and otherwise, even during a velocity stream,
            only as far as `advance` asks. 0 is always only as far as `advance` asks.
        clock: The time; the system's by default.

    Every method may be called from any thread. A cancelled or halted robot gets zero velocity
    before the call returns, and stands within 0.1 s of its own time.
    """

    def __init__(
        self,
        name: str,
        world: World,
        engine: Engine,
        *,
        speed: float | None = 1.0,
        clock: Clock | None = None,
    ) -> None:
        self.name = name
        self.world = world
        self.max_linear_m_s = world.robot.max_linear_m_s
        self.max_angular_rad_s = world.robot.max_angular_rad_s
        self._lock = threading.RLock()
        self._mux: CommandMux[FlatMotion] = CommandMux(
            self._lock,
            max_linear_m_s=self.max_linear_m_s,
            max_angular_rad_s=self.max_angular_rad_s,
            on_halt=lambda *_: self._run.ramp.brake(),
        )
        self._planner = PathPlanner(world)
        self._forbidden: Callable[[], Collection[str]] = tuple
        self._room_at = lru_cache(maxsize=1)(world.room_at)  # a robot at rest is asked all the time
        self._places = MappingProxyType({room.name: room.goal for room in world.rooms})
        self._ticks = 0
        self._engine = engine
        self._run = DiffDriveRun(world, engine, self._mux)
        hints = {room.name: room.hints for room in world.rooms}
        aliases = {said: room.name for room in world.rooms for said in room.aliases}
        names = {room.name: room.names for room in world.rooms}
        own = OneOf(tuple(self._places), aliases, names=names)
        self.place_memory = PlaceMemory(world.name, own)
        self._skills = (
            *navigation_skills(self, hints, aliases, memory=self.place_memory, names=names),
            *driving_skills(self),
        )
        self._sim_loop = SimLoop(
            self._step,
            period_s=STEP_S,
            speed=speed,
            clock=clock,
            name=f"{name} world",
            broke=self._give_up,
            rests=lambda: self._run.resting,
            lock=self._lock,
        )

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        self._sim_loop.catch_up()
        return self._now_s

    @property
    def _now_s(self) -> float:
        """The time of the last step."""
        return self._ticks * STEP_S

    @property
    def places(self) -> Mapping[str, tuple[float, float]]:
        return self._places

    @property
    def watchdog_halts(self) -> int:
        return self._mux.watchdog_halts

    def start(self) -> None:
        self._sim_loop.start()

    def _close(self) -> None:
        self._sim_loop.close()

    def reset(self) -> None:
        """Put everything back to the start, with a full battery; time goes on."""
        with self._lock:
            self._mux.halt(Cancelled(called_off("world_reset")))
            self._run = DiffDriveRun(self.world, self._engine, self._mux)
        self._sim_loop.wake()

    def pose(self) -> Pose2D:
        with self._lock:
            return self._run.motion.pose

    def velocity(self) -> Twist2D:
        with self._lock:
            return self._run.motion.twist

    def battery(self) -> float:
        return self._run.battery.charge  # not locked: a step that hangs must not hide how it is

    def battery_lasts_s(self) -> float:
        return self._run.battery.lasts_s(self.max_linear_m_s)

    def way_m(self, x_m: float, y_m: float) -> float:
        forbidden = self._forbidden_rooms()
        with self._lock:
            pose, movable = self._run.motion.pose, self._engine.movable_poses()
        way = self._planner.plan((pose.x_m, pose.y_m), (x_m, y_m), movable, forbidden)
        return sum(math.dist(one, other) for one, other in pairwise(way))

    def trail(self) -> tuple[Point, ...]:
        """Return the robot's path since the start or a reset, at most the last 5000 points."""
        with self._lock:
            return tuple(self._run.trail)

    def movable_poses(self) -> tuple[Pose2D, ...]:
        """Return the poses of the pushable things, in the world's order."""
        with self._lock:
            return self._engine.movable_poses()

    def scan(self) -> LidarScan:
        with self._lock:
            return self._engine.scan(self.time_s)

    def place_at(self, x_m: float, y_m: float) -> str | None:
        room = self._room_at(x_m, y_m)
        return room.name if room else None

    def set_velocity(self, twist: Twist2D) -> None:
        with self._lock:
            self._mux.stream(twist, self.time_s)
        self._sim_loop.wake()

    def limit_speed(self, limit: SpeedLimit) -> None:
        """Drive by itself no faster than this permits."""
        with self._lock:
            self._mux.limit = limit

    def avoid_places(self, forbidden: Callable[[], Collection[str]]) -> None:
        """Drive by itself round the rooms that this names whenever it is asked."""
        self._forbidden = forbidden

    def halt(self, reason: str) -> bool:
        with self._lock:
            moved = self._run.busy or self._run.moving
            self._mux.halt(Cancelled(reason))
        self._sim_loop.wake()
        return moved

    def check_goal(self, x_m: float, y_m: float) -> None:
        """Raise `SkillFailed` for a point outside the world."""
        self.world.bounds.check(x_m, y_m)

    def drive_to(self, x_m: float, y_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until there. Raises `SkillFailed` with a reason, `Cancelled` if it was ended.

        A halt, a velocity or another drive ends it. A refused drive disturbs nothing. The path
        avoids forbidden rooms, even those that become forbidden during the drive.
        """
        goal = (finite("x", x_m), finite("y", y_m))
        token.check()
        forbidden = self._forbidden_rooms()
        drive = self._begin(lambda: self._plan(goal, forbidden))
        self._mux.carry_out(drive, token, lambda: self._report(drive, report))

    def drive_straight(self, distance_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until that far ahead, or back if negative; raises as `drive_to` does.

        It goes round nothing: what its lidar sees in the way stops it.
        """
        distance_m = finite("distance", distance_m)
        self._go(lambda pose: StraightCourse(pose, distance_m, self.world.robot), token, report)

    def turn(self, angle_rad: float, *, token: CancelToken, report: Report) -> None:
        """Block until turned by that to the left, right if negative; raises as `drive_to` does."""
        angle_rad = finite("angle", angle_rad)
        self._go(lambda pose: TurnCourse(pose, angle_rad, self.world.robot), token, report)

    def state(self) -> Mapping[str, Any]:
        with self._lock:
            time_s, motion = self.time_s, self._run.motion
            charge, collisions = self._run.battery.charge, self._run.collisions
            goal = describe_goal(self._mux.motion)
        room = self.place_at(motion.pose.x_m, motion.pose.y_m)
        return {
            "name": self.name,
            "time": round(time_s, 3),
            "simulation": "physics",
            **describe_motion(motion),
            "room": room,
            "battery": round(charge, 4),
            "goal": goal,
            "touching": sorted(motion.touching),
            "collisions": collisions,
        }

    def way(self) -> tuple[Point, ...]:
        """The path that is still to be driven; empty where it drives nowhere by itself."""
        with self._lock:
            drive = self._mux.motion
            return drive.way() if drive else ()

    def draw_map(self, columns: int) -> str:
        with self._lock:
            pose, movable = self._run.motion.pose, self._engine.movable_poses()
            drive = self._mux.motion
            way = drive.way() if drive else ()
        return draw(self.world, pose, movable, way, columns)

    def picture(self) -> NDArray[np.uint8]:
        """The world from above, 800 pixels wide, with its last way and what its lidar sees."""
        with self._lock:
            pose, movable = self._run.motion.pose, self._engine.movable_poses()
            scan, trail = self._engine.scan(self.time_s), tuple(self._run.trail)
        trail = trail[-_TRAIL_SHOWN:]
        return np.asarray(self._painter.paint(pose, movable, trail=trail, scan=scan))

    @cached_property
    def _painter(self) -> "Painter":
        from edgevox.robots.flat.picture import Painter  # Pillow, which only pictures need

        return Painter(self.world, _PICTURE_PX, smoothing=2)

    @property
    def in_motion(self) -> bool:
        """Whether a goal moves it."""
        return self._mux.motion is not None

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed."""
        self._sim_loop.advance(seconds)

    def _go(self, course: Callable[[Pose2D], Course], token: CancelToken, report: Report) -> None:
        token.check()
        motion = self._begin(lambda: self._relative(course))
        self._mux.carry_out(motion, token, lambda: self._report_relative(motion, report))

    def _begin(self, make: Callable[[], FlatMotion]) -> FlatMotion:
        with self._lock:
            drive = self._mux.start(make)
            self._run.ramp.brake()
        self._sim_loop.wake()
        return drive

    def _forbidden_rooms(self) -> Sequence[Room]:
        """Return the forbidden rooms, without the lock: the policy may read a file."""
        names = frozenset(self._forbidden())
        return tuple(room for room in self.world.rooms if room.name in names)

    def _plan(self, goal: Point, forbidden: Sequence[Room]) -> NavigationMotion:
        self._check_ready()
        return NavigationMotion(
            goal,
            self._planner,
            self.world.robot,
            cruise_m_s=self._mux.limit(Twist2D(self.max_linear_m_s, 0.0)).linear_m_s,
            time_s=self.time_s,
            pose=self._run.motion.pose,
            movable=self._engine.movable_poses(),
            forbidden=forbidden,
        )

    def _relative(self, course: Callable[[Pose2D], Course]) -> FlatMotion:
        self._check_ready()
        pose = self._run.motion.pose
        wanted = course(pose)
        self.check_goal(wanted.goal.x_m, wanted.goal.y_m)
        return RelativeFlatMotion(
            wanted,
            self.world.robot,
            lambda: self._engine.scan(self._now_s),
            time_s=self.time_s,
            pose=pose,
        )

    def _check_ready(self) -> None:
        if not self._sim_loop.running:
            raise SkillFailed(because("switched_off"))
        if self._run.battery.empty:
            raise SkillFailed(because("battery_empty"))

    def _give_up(self) -> None:
        """End the motion after a failed step: the next one might do anything with it."""
        self._mux.halt(SkillFailed(BROKE))

    def _report(self, drive: FlatMotion, report: Report) -> None:
        forbidden = self._forbidden_rooms()
        with self._lock:
            drive.avoid(forbidden)
            progress, pose = drive.progress(), self._run.motion.pose
        report(
            progress=round(progress.part, 3),
            distance_m=round(progress.left, 3),
            x=round(pose.x_m, 3),
            y=round(pose.y_m, 3),
        )

    def _report_relative(self, motion: FlatMotion, report: Report) -> None:
        with self._lock:
            progress, pose = motion.progress(), self._run.motion.pose
        report(**progress.as_values(), **where(pose))

    def _step(self) -> bool:
        """Do a step of the world, on the sim loop's thread. Return whether more is to come."""
        with self._lock:
            self._ticks += 1
            self._run.step(self._now_s)
            return self._mux.velocity is None and (self._run.busy or self._run.moving)
