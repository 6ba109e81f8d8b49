"""Numbers of a simulated world that break: what moved stops, the goal says why, all goes on.

They are broken where a real divergence would begin, in the engine itself; time passes as the test
says, so that every single step after it can be looked at.
"""

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pytest
from engines import meddled
from held_time import STEP_S, HeldSkill
from humanoid_rig import g1, h1
from panda_table import open_panda

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.core.languages import LANGUAGES
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import MotionState
from edgevox.robots.flat.irsim import IrsimRobot
from edgevox.robots.humanoid import HumanoidRobot, MujocoHumanoidEnvironment
from edgevox.robots.sim_loop import BROKE
from edgevox.robots.world.load import load_world

NAN = math.nan


Poison = Callable[[], None]


@dataclass(frozen=True)
class Case:
    """A body and a way in which its numbers break, and something that it does for a while."""

    build: Callable[[], tuple[Any, Poison]]
    goal: Callable[..., None]


def drive(robot, **handle) -> None:
    robot.drive_to(*robot.places["kitchen"], **handle)


def walk(robot, **handle) -> None:
    robot.walk(3.0, **handle)


def reach(robot, **handle) -> None:
    robot.move_to(0.4, 0.3, 0.3, **handle)


def with_wheels(kind: type[DiffDriveRobot]) -> tuple[Any, Poison]:
    """Its wheels are told what is no number, once."""
    robot, engine = meddled(kind, load_world(), speed=0.0)

    def break_once(_: Twist2D, step: Callable[[Twist2D], MotionState]) -> MotionState:
        engine.meddle = None
        return step(Twist2D(NAN, NAN))

    def poison() -> None:
        engine.meddle = break_once

    return robot, poison


def with_furniture() -> tuple[Any, Poison]:
    """A chair is where no chair can be."""
    robot, engine = meddled(ApartmentRobot, load_world(), speed=0.0)

    def poison() -> None:
        engine.put(robot.pose(), [Pose2D(NAN, NAN, 0.0), *robot.movable_poses()[1:]])

    return robot, poison


def with_legs(make: Callable[[], MujocoHumanoidEnvironment], field: str) -> tuple[Any, Poison]:
    environment = make()

    def poison() -> None:
        getattr(environment.data, field)[:] = NAN

    return HumanoidRobot(environment, speed=0.0), poison


def with_arm(field: str, value: float) -> tuple[Any, Poison]:
    robot = open_panda(speed=0.0)

    def poison() -> None:
        getattr(robot.world.data, field)[3] = value

    return robot, poison


CASES = {
    "apartment": Case(partial(with_wheels, ApartmentRobot), drive),
    "apartment, furniture": Case(with_furniture, drive),
    "irsim": Case(partial(with_wheels, IrsimRobot), drive),
    "panda": Case(partial(with_arm, "qpos", NAN), reach),
    "panda, speed": Case(partial(with_arm, "qvel", 1e12), reach),
    "g1": Case(partial(with_legs, g1, "qvel"), walk),
    "h1, no physics": Case(partial(with_legs, h1, "qpos"), walk),
}


def going(robot, case: Case) -> HeldSkill:
    """A goal that has begun and moves the robot."""
    return HeldSkill(robot, case.goal, robot).until(lambda: moves(robot))


@pytest.fixture(params=CASES, ids=str)
def case(request, tmp_path, monkeypatch) -> Case:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log there
    return CASES[request.param]


@pytest.fixture
def broken(case) -> Iterator[tuple[Any, Poison]]:
    """The body, in a world whose time stands still until it is told, and what breaks it."""
    robot, poison = case.build()
    with robot:
        yield robot, poison


def speeds(robot) -> list[float]:
    velocity = robot.state()["velocity"]
    return velocity["joints"] if "joints" in velocity else list(velocity.values())


def moves(robot) -> bool:
    return max(map(abs, speeds(robot))) > 0.1


def check_numbers(robot) -> None:
    """Everything that goes onto the wire is a number, and JSON that every parser reads."""
    json.dumps(robot.state(), allow_nan=False)
    if hasattr(robot, "pose"):
        assert robot.pose().finite
        assert robot.velocity().finite
    if hasattr(robot, "end_effector"):
        hand = robot.end_effector()
        assert all(map(math.isfinite, (hand.x_m, hand.y_m, hand.z_m, hand.qw)))
    if hasattr(robot, "scan"):
        assert not np.isnan(robot.scan().ranges_m).any()


def test_the_goal_fails_with_a_reason_and_the_robot_stands_within_a_step_or_two(case, broken):
    robot, poison = broken
    asked = going(robot, case)
    poison()

    before = robot.breaks
    for _ in range(10):  # furniture is looked at every tenth step
        robot.advance(STEP_S)
        if robot.breaks > before:
            break
    check_numbers(robot)

    error = asked.ended()
    assert isinstance(error, SkillFailed)
    assert error.reason == BROKE
    assert robot.breaks == before + 1
    assert robot.state()["goal"] is None
    assert not moves(robot)
    for _ in range(20):
        robot.advance(STEP_S)
        check_numbers(robot)
    assert robot.breaks == before + 1, "it broke once, and was put back"


def test_the_next_goal_is_carried_out_and_a_reset_brings_it_back_to_the_start(case, broken):
    robot, poison = broken
    start = robot.state()
    first = going(robot, case)
    poison()
    while robot.breaks == 0:
        robot.advance(STEP_S)
    first.ended()

    again = going(robot, case)
    again.token.cancel("the test is over")
    again.ended()

    robot.reset()
    robot.advance(STEP_S)
    now = robot.state()
    assert now["pose"] == pytest.approx(start["pose"], abs=0.02)


@pytest.mark.parametrize("code", ["en", "de", "fr"])
def test_the_reason_is_spoken_in_the_persons_language(code):
    said = phrasebook(code).failure(BROKE)

    assert (said == phrasebook("en").failure(BROKE)) == (code == "en")
    assert code in LANGUAGES
