"""How fast the 2D apartment is: steps and scans per second, milliseconds per plan."""

import time
from collections.abc import Callable

from benchmarks.core.figures import Figure, Measured
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import Lidar, PymunkEngine
from edgevox.robots.flat.engine import STEP_S
from edgevox.robots.flat.planner import PathPlanner
from edgevox.robots.flat.text_map import draw
from edgevox.robots.world.load import load_world

TABLE = "The 2D apartment"
ROUNDS = 5


def seconds(work: Callable[[], object], times: int, rounds: int) -> list[float]:
    """The mean time that one call takes, once for each round."""
    taken = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(times):
            work()
        taken.append((time.perf_counter() - start) / times)
    return taken


def measure(quick: bool = False) -> Measured:
    """The 2D world's parts, one after the other."""
    rounds = 2 if quick else ROUNDS
    world = load_world()
    physics, lidar, planner = PymunkEngine(world), Lidar(world), PathPlanner(world)
    pose, movable = world.robot.start, physics.movable_poses()
    goals = {room.name: room.goal for room in world.rooms}
    step = seconds(lambda: physics.step(Twist2D(0.5, 1.0)), 2000, rounds)
    scan = seconds(lambda: lidar.scan(0.0, pose, movable), 200, rounds)
    plan = seconds(lambda: planner.plan(goals["kitchen"], goals["bedroom"], movable), 10, rounds)
    text = seconds(lambda: draw(world, pose, movable, (), 70), 5, rounds)
    load = seconds(load_world, 2, rounds)
    return Measured(
        figures=(
            _rate("steps", "physics steps", step, 1.0),
            _rate("real_time", "seconds of the world", step, STEP_S),
            _rate("scans", "lidar scans of 360 beams", scan, 1.0),
            _ms("plan", "plan through the whole apartment", plan),
            _ms("map", "map of 70 columns as text", text),
            _ms("load", "world file read and checked", load),
        )
    )


def _rate(identifier: str, what: str, taken: list[float], each: float) -> Figure:
    samples = [each / one for one in taken]
    return Figure.of(identifier, TABLE, what, samples, "a second", more_is_better=True)


def _ms(identifier: str, what: str, taken: list[float]) -> Figure:
    return Figure.of(identifier, TABLE, what, [1000 * one for one in taken], "ms")
