"""Humanoids for the tests, and somebody who asks them for things while the test looks on."""

import math
import threading
from collections.abc import Callable

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.robots.capabilities import Pose2D
from edgevox.robots.humanoid import (
    HumanoidRobot,
    MujocoHumanoidEnvironment,
    OnnxWalkingPolicy,
)

Report = Callable[..., None]


def g1(seed: int = 0) -> MujocoHumanoidEnvironment:
    """In physics. The files come with `edgevox-models fetch unitree-g1 g1-walking-policy`."""
    policy = OnnxWalkingPolicy(locate("g1-walking-policy"))
    return MujocoHumanoidEnvironment(locate("unitree-g1"), policy, seed=seed)


def h1() -> MujocoHumanoidEnvironment:
    """Moved outright. The files come with `edgevox-models fetch unitree-h1`."""
    return MujocoHumanoidEnvironment(locate("unitree-h1"))


def silent(**_: object) -> None:
    """A report that nobody reads."""


def walk(robot: HumanoidRobot, distance_m: float) -> None:
    robot.walk(distance_m, token=CancelToken(), report=silent)


def turn(robot: HumanoidRobot, degrees: float) -> None:
    robot.turn(math.radians(degrees), token=CancelToken(), report=silent)


def stand(robot: HumanoidRobot) -> bool:
    return robot.stand(token=CancelToken(), report=silent)


def along(before: Pose2D, after: Pose2D) -> float:
    """Metres from one to the other in the direction that the first looks."""
    x, y = after.x_m - before.x_m, after.y_m - before.y_m
    return math.cos(before.yaw_rad) * x + math.sin(before.yaw_rad) * y


def turned_deg(before: Pose2D, after: Pose2D) -> float:
    """Degrees to the left, -180 to 180."""
    return math.degrees(math.remainder(after.yaw_rad - before.yaw_rad, math.tau))


def apart(one: Pose2D, other: Pose2D) -> float:
    return math.hypot(other.x_m - one.x_m, other.y_m - one.y_m)


class Asking:
    """A manoeuvre that runs on a thread of its own, in a world that the test advances."""

    def __init__(self, robot: HumanoidRobot, ask: Callable[[CancelToken, Report], object]) -> None:
        self.token = CancelToken()
        self.reports: list[dict[str, object]] = []
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, args=(ask,))
        self._thread.start()
        while robot.state()["goal"] is None and self._thread.is_alive():
            self._thread.join(0.001)

    def _run(self, ask: Callable[[CancelToken, Report], object]) -> None:
        try:
            ask(self.token, lambda **feedback: self.reports.append(feedback))
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error

    def end(self) -> BaseException | None:
        """Wait for it; what it raised, if anything."""
        self._thread.join(20)
        assert not self._thread.is_alive()
        return self.error


def walking(robot: HumanoidRobot, distance_m: float) -> Asking:
    """A walk that was just asked for."""
    return Asking(robot, lambda token, report: robot.walk(distance_m, token=token, report=report))
