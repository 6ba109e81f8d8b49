"""How fast the Panda's world is, next to plain steps of the same model under the same commands."""

import statistics
import threading
import time
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.scene import STEP_S, build
from edgevox.robots.panda.workcell import PERIOD_S

BODY = "robot-panda"
REST_S = 20.0
FLAT_OUT = 1000.0
CAMERA_HZ = 5.0
ROUNDS = 5
SUBSTEPS = round(PERIOD_S / STEP_S)
WORK = (("red_cube", "left_bin"), ("green_cube", "right_bin"), ("blue_cube", "left_bin"))


def work(robot: PandaRobot) -> None:
    """What the arm does while it is measured: tidy all cubes away, and go home."""
    for cube, target in WORK:
        robot.place(cube, target, token=CancelToken(), report=lambda **_: None)
    robot.go_home(token=CancelToken(), report=lambda **_: None)


def watched(robot: PandaRobot, busy: Callable[[], bool]) -> None:
    """Let time pass while busy, with a picture every fifth of a second."""
    while busy():
        robot.advance(1.0 / CAMERA_HZ)
        robot.camera()


def measure() -> list[dict[str, object]]:
    """Rows of body, what, and real_time_factor: median of rounds that take turns."""
    path = locate("franka-panda")
    commands = recorded(path)
    runs: dict[str, Callable[[], float]] = {
        "plain mj_step, resting": lambda: plain(
            path, np.repeat(commands[:1], REST_S / PERIOD_S, 0)
        ),
        "resting": lambda: resting(path),
        "resting, camera at 5 Hz": lambda: resting_watched(path),
        "plain mj_step, the same motor commands": lambda: plain(path, commands),
        "picking and placing": lambda: working(path),
        "picking and placing, camera at 5 Hz": lambda: working_watched(path),
    }
    factors: dict[str, list[float]] = {what: [] for what in runs}
    for _ in range(ROUNDS):
        for what, run in runs.items():
            factors[what].append(run())
    return [
        {"body": BODY, "what": what, "real_time_factor": statistics.median(found)}
        for what, found in factors.items()
    ]


def recorded(path: Path) -> np.ndarray:
    """(n, 8): what the motors are told in each period of the work."""
    rows: list[np.ndarray] = []
    with_work = PandaRobot(path, speed=None)
    cell = with_work._cell  # noqa: SLF001
    tick = cell.arm.tick

    def noted() -> bool:
        busy = tick()
        rows.append(cell.engine.data.ctrl.copy())
        return busy

    cell.arm.tick = noted
    with with_work:
        work(with_work)
    return np.array(rows)


def plain(path: Path, commands: np.ndarray) -> float:
    """The engine alone, with these commands."""
    robot = PandaRobot(path)
    start = robot._engine.snapshot()  # noqa: SLF001
    model = build(path)
    data = mujoco.MjData(model)
    start.show_in(model, data)
    began = time.perf_counter()
    for row in commands:
        data.ctrl[:] = row
        mujoco.mj_step(model, data, SUBSTEPS)
    return len(commands) * PERIOD_S / (time.perf_counter() - began)


def resting(path: Path) -> float:
    """The robot with nothing to do, as fast as its thread can."""
    with PandaRobot(path, speed=FLAT_OUT) as robot:
        began, since = time.perf_counter(), robot.time_s
        time.sleep(REST_S / 40)
        return (robot.time_s - since) / (time.perf_counter() - began)


def resting_watched(path: Path) -> float:
    """The robot with nothing to do, under the eyes of its camera."""
    with PandaRobot(path, speed=0.0) as robot:
        robot.camera()
        began, since = time.perf_counter(), robot.time_s
        watched(robot, lambda: robot.time_s - since < REST_S / 4)
        return (robot.time_s - since) / (time.perf_counter() - began)


def working(path: Path) -> float:
    """The robot at work, planning and all."""
    with PandaRobot(path, speed=None) as robot:
        began = time.perf_counter()
        work(robot)
        return robot.time_s / (time.perf_counter() - began)


def working_watched(path: Path) -> float:
    """The robot at work under the eyes of its camera."""
    with PandaRobot(path, speed=0.0) as robot:
        robot.camera()
        worker = threading.Thread(target=work, args=(robot,))
        began = time.perf_counter()
        worker.start()
        watched(robot, worker.is_alive)
        worker.join()
        return robot.time_s / (time.perf_counter() - began)


def main() -> None:
    """Measure and print."""
    for row in measure():
        print(f"  {row['what']:42} {row['real_time_factor']:8.1f}")


if __name__ == "__main__":
    main()
