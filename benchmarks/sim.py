"""How fast the 2D apartment is: steps and scans per second, milliseconds per plan."""

import platform
import statistics
import time
from collections.abc import Callable

from edgevox.robots.capabilities import Twist2D
from edgevox.robots.engine import STEP_S
from edgevox.robots.lidar import Lidar
from edgevox.robots.physics import PymunkEngine
from edgevox.robots.planner import Planner
from edgevox.robots.text_map import draw
from edgevox.robots.world import load_world

UNITS = {
    "steps_per_s": "physics steps a second",
    "real_time_factor": "seconds of the world in a second",
    "scans_per_s": "lidar scans of 360 beams a second",
    "plan_ms": "plan through the whole apartment, ms",
    "map_ms": "map of 70 columns as text, ms",
    "load_ms": "world file read and checked, ms",
}


def seconds(work: Callable[[], object], times: int, rounds: int = 5) -> float:
    """Median over the rounds of the mean time that one call takes."""
    taken = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(times):
            work()
        taken.append((time.perf_counter() - start) / times)
    return statistics.median(taken)


def measure() -> dict[str, float]:
    """The figures by the names in `UNITS`."""
    world = load_world()
    physics, lidar, planner = PymunkEngine(world), Lidar(world), Planner(world)
    pose, movable = world.robot.start, physics.movable_poses()
    goals = {room.name: room.goal for room in world.rooms}
    step = seconds(lambda: physics.step(Twist2D(0.5, 1.0)), 2000)
    scan = seconds(lambda: lidar.scan(0.0, pose, movable), 200)
    plan = seconds(lambda: planner.plan(goals["kitchen"], goals["bedroom"], movable), 10)
    text = seconds(lambda: draw(world, pose, movable, (), 70), 5)
    load = seconds(load_world, 2)
    return {
        "steps_per_s": 1 / step,
        "real_time_factor": STEP_S / step,
        "scans_per_s": 1 / scan,
        "plan_ms": 1000 * plan,
        "map_ms": 1000 * text,
        "load_ms": 1000 * load,
    }


def main() -> None:
    """Measure and print."""
    print(f"2D apartment on {platform.node()}, {platform.machine()}, {platform.python_version()}")
    for name, value in measure().items():
        print(f"  {UNITS[name]:42} {value:12,.1f}")


if __name__ == "__main__":
    main()
