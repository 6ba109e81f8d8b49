"""How fast the Panda's world is, next to plain steps of the same model under the same commands."""

import threading
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from benchmarks.core.stopwatch import Stopwatch
from benchmarks.robots.worlds import Row, Run, compare
from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.scene import STEP_S, build
from edgevox.robots.panda.workcell import PERIOD_S, Workcell

BODY = "robot-panda"
WORLD = f"{BODY} world"
REST_S = 6.0
CAMERA_HZ = 5.0
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


def recorded(path: Path) -> np.ndarray:
    """(n, 8): what the motors are told in each period of the work."""
    rows: list[np.ndarray] = []
    cell = Workcell(path, speed=None)
    tick = cell.arm.tick

    def noted() -> bool:
        busy = tick()
        rows.append(cell.engine.data.ctrl.copy())
        return busy

    cell.arm.tick = noted
    with PandaRobot(cell) as robot:
        work(robot)
    return np.array(rows)


def plain(path: Path, commands: np.ndarray) -> Run:
    """The engine alone, with these commands."""
    start = Workcell(path).engine.snapshot()
    model = build(path)
    data = mujoco.MjData(model)
    start.show_in(model, data)
    with Stopwatch() as watch:
        for row in commands:
            data.ctrl[:] = row
            mujoco.mj_step(model, data, SUBSTEPS)
    return Run(len(commands) * PERIOD_S, watch.spent)


def resting(path: Path) -> Run:
    """The robot with nothing to do."""
    with PandaRobot(Workcell(path, speed=0.0)) as robot:
        with Stopwatch(WORLD) as watch:
            robot.advance(REST_S)
        return Run(robot.time_s, watch.spent)


def resting_watched(path: Path) -> Run:
    """The robot with nothing to do, under the eyes of its camera."""
    with PandaRobot(Workcell(path, speed=0.0)) as robot:
        robot.camera()
        with Stopwatch(WORLD) as watch:
            watched(robot, lambda: robot.time_s < REST_S / 2)
        return Run(robot.time_s, watch.spent)


def working(path: Path) -> Run:
    """The robot at work, planning and all."""
    with PandaRobot(Workcell(path, speed=None)) as robot:
        with Stopwatch(WORLD) as watch:
            work(robot)
        return Run(robot.time_s, watch.spent)


def working_watched(path: Path) -> Run:
    """The robot at work under the eyes of its camera."""
    with PandaRobot(Workcell(path, speed=0.0)) as robot:
        robot.camera()
        worker = threading.Thread(target=work, args=(robot,))
        with Stopwatch(WORLD) as watch:
            worker.start()
            watched(robot, worker.is_alive)
            worker.join()
        return Run(robot.time_s, watch.spent)


def measure(rounds: int) -> list[Row]:
    """At rest and at work, and both with the camera on."""
    path = locate("franka-panda")
    commands = recorded(path)
    rest = np.repeat(commands[:1], round(REST_S / PERIOD_S), 0)
    return [
        compare(BODY, "resting", lambda: resting(path), lambda: plain(path, rest), rounds=rounds),
        Row(BODY, "resting, camera at 5 Hz", 1 / resting_watched(path).cost),
        compare(
            BODY,
            "picking and placing",
            lambda: working(path),
            lambda: plain(path, commands),
            rounds=rounds,
        ),
        Row(BODY, "picking and placing, camera at 5 Hz", 1 / working_watched(path).cost),
    ]
