"""A Panda at its table, and what tests do with it."""

import threading
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
    """Call a skill's method and wait for its end."""
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


class Asked:
    """A skill's method on a thread of its own, as a goal runs it."""

    def __init__(self, robot: PandaRobot, skill: Callable[..., Any], *arguments: object) -> None:
        self.token = CancelToken()
        self.reports: list[dict[str, Any]] = []
        self.error: BaseException | None = None
        self._robot = robot
        self._thread = threading.Thread(target=self._run, args=(skill, arguments))
        self._thread.start()

    def until(self, phase: str) -> "Asked":
        """Let time pass until it does this, and moves."""
        while self._thread.is_alive():
            goal = self._robot.state()["goal"]
            if goal and goal["phase"].startswith(phase) and turning_rad_s(self._robot) > 0.3:
                return self
            self._robot.advance(0.02)
        raise AssertionError(f"it ended before it was {phase}: {self.error}")

    def end(self) -> BaseException | None:
        """Wait for it; what it raised, if anything."""
        self._thread.join(30)
        assert not self._thread.is_alive()
        return self.error

    def _run(self, skill: Callable[..., Any], arguments: tuple[object, ...]) -> None:
        try:
            skill(*arguments, token=self.token, report=lambda **f: self.reports.append(f))
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error
