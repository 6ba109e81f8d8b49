"""What the 2D bodies add to the simulators under them.

The whole body (planner, command mux, battery, locks, its thread) drives to two rooms. Right after
each of its steps a second world in the bare simulator makes the same step, so that both meet the
same machine, whatever else runs on it. Time is that of the processor.
"""

import math
import time
from collections.abc import Callable

from wrapped_engine import WrappedEngine

from benchmarks.robots.worlds import Row
from edgevox.core.cancel import CancelToken
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import STEP_S, Engine, MotionState
from edgevox.robots.flat.irsim import IrsimEngine, make_environment
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import World

TOUR = ("kitchen", "living_room")
SCAN_EVERY_STEPS = 5

Step = Callable[[Twist2D], None]
Scan = Callable[[], object]


class Beside(WrappedEngine):
    """An engine that lets a bare simulator do each step, and its scan at 10 Hz, once more."""

    def __init__(self, engine: Engine, bare: tuple[Step, Scan], *, lidar: bool) -> None:
        super().__init__(engine)
        self._lidar = lidar
        self._step, self._scan = bare
        self.steps = 0
        self.bare_s = 0.0

    def step(self, command: Twist2D) -> MotionState:
        self.steps += 1
        scans = self._lidar and self.steps % SCAN_EVERY_STEPS == 0
        motion = self._engine.step(command)
        if scans:
            self._engine.scan(0.0)
        began_s = time.thread_time()
        self._step(command)
        if scans:
            self._scan()
        self.bare_s += time.thread_time() - began_s
        return motion


def bare_irsim(world: World) -> tuple[Step, Scan]:
    """IR-SIM's `env.step`, without the rays that it would cast at every step, and its lidar."""
    env = make_environment(world)
    lidar = env.robot.lidar
    env.robot.sensors.clear()
    return (
        lambda command: env.step([command.linear_m_s, command.angular_rad_s]),
        lambda: lidar.step(env.robot.state[:3]),
    )


def bare_pymunk(world: World) -> tuple[Step, Scan]:
    """The `Space.step` of pymunk; it has no lidar, so that one is ours."""
    engine = PymunkEngine(world)
    space, robot, wheels = engine._space, engine._robot, engine._wheels  # noqa: SLF001 - the bare parts

    def step(command: Twist2D) -> None:
        wheels.angular_velocity = command.angular_rad_s
        for _ in range(2):
            ahead, yaw_rad = command.linear_m_s, robot.angle
            wheels.velocity = math.cos(yaw_rad) * ahead, math.sin(yaw_rad) * ahead
            space.step(STEP_S / 2)

    return step, lambda: engine.scan(0.0)


def drive(engine: Beside, world: World) -> tuple[float, float]:
    """Seconds that a step took the whole body, and the bare simulator."""
    with DiffDriveRobot("robot", world, engine, speed=None) as robot:
        began_s = time.process_time()
        for room in TOUR:
            robot.drive_to(*robot.places[room], token=CancelToken(), report=lambda **_: None)
        both_s = time.process_time() - began_s
    return (both_s - engine.bare_s) / engine.steps, engine.bare_s / engine.steps


def measure(rounds: int) -> list[Row]:
    """Both 2D bodies, without and with their lidar; planning is part of what a step takes."""
    world = load_world()
    rows: list[Row] = []
    for body, make, make_bare in (
        ("robot-apartment", PymunkEngine, bare_pymunk),
        ("robot-irsim", IrsimEngine, bare_irsim),
    ):
        for lidar, what in ((False, "driving"), (True, "driving, lidar at 10 Hz")):
            whole_s, bare_s = min(
                drive(Beside(make(world), make_bare(world), lidar=lidar), world)
                for _ in range(rounds)
            )
            rows.append(
                Row(
                    body,
                    what,
                    STEP_S / whole_s,
                    STEP_S / bare_s,
                    whole_s / bare_s - 1,
                    whole_s - bare_s,
                )
            )
    return rows
