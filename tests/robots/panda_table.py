"""A Panda at its table, and what tests do with it."""

from collections.abc import Callable
from typing import Any

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.table import CUBE_SIZE_M
from edgevox.robots.panda.workcell import Workcell

LIFTED_M = 0.05


class Panda(PandaRobot):
    """A Panda whose world the test can reach into, as a person at the table can."""

    def __init__(self, cell: Workcell) -> None:
        super().__init__(cell)
        self.world = cell.engine


def open_panda(seed: int = 0, speed: float | None = None) -> Panda:
    """Not yet started. Fails with the command that fetches the model where it is missing."""
    return Panda(Workcell(locate("franka-panda"), seed=seed, speed=speed))


def ask(skill: Callable[..., Any], *arguments: object) -> Any:
    """Call a skill's method and wait for its end, in a world whose time passes meanwhile."""
    return skill(*arguments, token=CancelToken(), report=lambda **_: None)


def is_lifted(robot: PandaRobot, name: str) -> bool:
    """Whether this cube is held above the table."""
    state = robot.state()
    return state["held"] == name and state["objects"][name]["z"] > CUBE_SIZE_M / 2 + LIFTED_M


def put_cube(robot: Panda, name: str, x_m: float, y_m: float, z_m: float) -> None:
    """Somebody moves a cube by hand."""
    with robot.world.lock:
        robot.world.data.joint(name).qpos[:] = x_m, y_m, z_m, 1.0, 0.0, 0.0, 0.0
        robot.world.data.joint(name).qvel[:] = 0.0


def turning_rad_s(robot: PandaRobot) -> float:
    """How fast the fastest joint of the arm turns."""
    return max(map(abs, robot.state()["velocity"]["joints"]))


def moving(robot: PandaRobot, phase: str) -> Callable[[], bool]:
    """Whether it does this, and moves."""

    def true() -> bool:
        goal = robot.state()["goal"]
        return bool(goal) and goal["phase"].startswith(phase) and turning_rad_s(robot) > 0.3

    return true
