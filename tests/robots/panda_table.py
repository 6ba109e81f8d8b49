"""A Panda at its table, and what tests do with it."""

from collections.abc import Callable
from typing import Any

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.robots.panda.layout import CUBE_SIZE_M
from edgevox.robots.panda.robot import PandaRobot

LIFTED_M = 0.05


def open_panda(seed: int = 0, speed: float | None = None) -> PandaRobot:
    """Not yet started. Fails with the command that fetches the model where it is missing."""
    return PandaRobot(locate("franka-panda"), seed=seed, speed=speed)


def ask(skill: Callable[..., Any], *arguments: object) -> Any:
    """Call a skill's method and wait for its end, in a world whose time passes meanwhile."""
    return skill(*arguments, token=CancelToken(), report=lambda **_: None)


def is_lifted(robot: PandaRobot, name: str) -> bool:
    """Whether this cube is held above the table."""
    state = robot.state()
    return state["held"] == name and state["objects"][name]["z"] > CUBE_SIZE_M / 2 + LIFTED_M


def put_cube(robot: PandaRobot, name: str, x_m: float, y_m: float, z_m: float) -> None:
    """Somebody moves a cube by hand."""
    engine = robot._engine
    with engine.lock:
        engine.data.joint(name).qpos[:] = x_m, y_m, z_m, 1.0, 0.0, 0.0, 0.0
        engine.data.joint(name).qvel[:] = 0.0


def turning_rad_s(robot: PandaRobot) -> float:
    """How fast the fastest joint of the arm turns."""
    with robot._engine.lock:
        return float(abs(robot._engine.data.qvel[:7]).max())


def moving(robot: PandaRobot, phase: str) -> Callable[[], bool]:
    """Whether it does this, and moves."""

    def true() -> bool:
        goal = robot.state()["goal"]
        return bool(goal) and goal["phase"].startswith(phase) and turning_rad_s(robot) > 0.3

    return true
