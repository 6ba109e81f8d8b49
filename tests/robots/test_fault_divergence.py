"""Numbers of a simulated world that break: what moved stops, the goal says why, all goes on.

They are broken where a real divergence would begin, in the engine itself; time passes as the test
says, so that every single step after it can be looked at.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from held_time import STEP_S, Asked
from humanoid_stage import g1, h1
from panda_table import open_panda

from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.core.languages import LANGUAGES
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.humanoid import HumanoidRobot
from edgevox.robots.irsim import IrsimRobot
from edgevox.robots.stepper import BROKE

NAN = math.nan


@dataclass(frozen=True)
class Case:
    """A body, something that it does for a while, and a way in which its numbers break."""

    make: Callable[..., Any]
    goal: Callable[..., None]
    poison: Callable[[Any], None]


def drive(robot, **handle) -> None:
    robot.drive_to(*robot.places["kitchen"], **handle)


def walk(robot, **handle) -> None:
    robot.walk(3.0, **handle)


def reach(robot, **handle) -> None:
    robot.move_to(0.4, 0.3, 0.3, **handle)


def break_wheels(robot) -> None:
    robot._engine._robot.velocity = (NAN, NAN)


def break_chair(robot) -> None:
    robot._engine._movable[0].velocity = (NAN, 0.0)


def break_irsim(robot) -> None:
    robot._engine._robot._state[:] = NAN


def break_walker(field: str) -> Callable[[HumanoidRobot], None]:
    def poison(robot: HumanoidRobot) -> None:
        getattr(robot._environment.data, field)[:] = NAN

    return poison


def break_arm(field: str, value: float) -> Callable[[Any], None]:
    def poison(robot) -> None:
        getattr(robot._engine.data, field)[3] = value

    return poison


CASES = {
    "apartment": Case(ApartmentRobot, drive, break_wheels),
    "apartment, furniture": Case(ApartmentRobot, drive, break_chair),
    "irsim": Case(IrsimRobot, drive, break_irsim),
    "panda": Case(open_panda, reach, break_arm("qpos", NAN)),
    "panda, speed": Case(open_panda, reach, break_arm("qvel", 1e12)),
    "g1": Case(lambda **how: HumanoidRobot(g1(), **how), walk, break_walker("qvel")),
    "h1, no physics": Case(lambda **how: HumanoidRobot(h1(), **how), walk, break_walker("qpos")),
}


def going(robot, case: Case) -> Asked:
    """A goal that has begun and moves the robot."""
    return Asked(robot, case.goal, robot).until(lambda: moves(robot))


@pytest.fixture(params=CASES, ids=str)
def case(request, tmp_path, monkeypatch) -> Case:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log there
    return CASES[request.param]


@pytest.fixture
def robot(case, held):
    return held(case.make)


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


def test_the_goal_fails_with_a_reason_and_the_robot_stands_within_a_step_or_two(case, robot):
    asked = going(robot, case)
    case.poison(robot)

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


def test_the_next_goal_is_carried_out_and_a_reset_brings_it_back_to_the_start(case, robot):
    start = robot.state()
    first = going(robot, case)
    case.poison(robot)
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
