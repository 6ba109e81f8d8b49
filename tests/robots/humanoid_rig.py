"""Humanoids for the tests, and what tests ask of them."""

import math

from held_time import HeldSkill

from edgevox.core.cancel import CancelToken
from edgevox.core.transforms import Pose2D
from edgevox.models import locate
from edgevox.robots.humanoid import (
    HumanoidRobot,
    MujocoHumanoidEnvironment,
    OnnxWalkingPolicy,
)


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


def walking(robot: HumanoidRobot, distance_m: float) -> HeldSkill:
    """A walk that was just asked for, where time is held."""
    return HeldSkill(robot, robot.walk, distance_m)
