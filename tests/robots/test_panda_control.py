"""Who may move the Panda, and how everything stops."""

import json
from collections.abc import Iterator

import phrases
import pytest
from held_time import HeldSkill, carry_out
from panda_table import ask, is_lifted, moving, open_panda, turning_rad_s

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.robots.panda.robot import PandaRobot

BRAKE_TIME_S = 0.1
STILL_RAD_S = 0.05


@pytest.fixture
def panda() -> Iterator[PandaRobot]:
    with open_panda() as robot:
        yield robot


@pytest.fixture
def held_panda(held) -> PandaRobot:
    """Its time stands still until it is told."""
    return held(open_panda)


def test_a_halt_stops_the_arm_and_keeps_what_it_holds(held_panda) -> None:
    carry_out(held_panda, held_panda.grasp, "red_cube")
    asked = HeldSkill(held_panda, held_panda.place, "red_cube", "left_bin")
    asked.until(moving(held_panda, "taking"))

    assert held_panda.halt("the stop word")
    held_panda.advance(BRAKE_TIME_S)
    assert turning_rad_s(held_panda) < STILL_RAD_S
    before = held_panda.end_effector()
    held_panda.advance(1.0)

    assert str(asked.ended()) == "the stop word"
    assert is_lifted(held_panda, "red_cube")
    assert held_panda.state()["goal"] is None
    after = held_panda.end_effector()
    assert (after.x_m, after.y_m, after.z_m) == pytest.approx(
        (before.x_m, before.y_m, before.z_m), abs=0.01
    )


def test_after_a_halt_the_work_can_go_on(held_panda) -> None:
    carry_out(held_panda, held_panda.grasp, "red_cube")
    asked = HeldSkill(held_panda, held_panda.place, "red_cube", "left_bin")
    asked.until(moving(held_panda, "taking"))
    held_panda.halt("enough")
    asked.ended()

    carry_out(held_panda, held_panda.place, None, "right_bin")

    assert held_panda.describe_objects()["objects"]["red_cube"]["on"] == "right_bin"


def test_halting_an_arm_at_rest_stops_nothing(panda) -> None:
    ask(panda.go_home)

    assert not panda.halt("to be sure")


@pytest.mark.parametrize(
    ("act", "reason"),
    [
        (lambda robot, asked: asked.token.cancel("never mind"), "never mind"),
        (lambda robot, asked: robot.reset(), "the world was reset"),
        (lambda robot, asked: robot.close(), "the robot was switched off"),
        (
            lambda robot, asked: carry_out(robot, robot.release),
            phrases.why("preempted", skill="release"),
        ),
    ],
)
def test_what_ends_an_errand_is_its_reason(held_panda, act, reason) -> None:
    asked = HeldSkill(held_panda, held_panda.move_to, 0.4, 0.3, 0.2)
    asked.until(moving(held_panda, "moving"))

    act(held_panda, asked)

    error = asked.ended()
    assert isinstance(error, Cancelled)
    assert str(error) == reason


def test_a_token_that_is_cancelled_already_starts_nothing(panda) -> None:
    token = CancelToken()
    panda.go_home(token=token, report=lambda **_: None)
    token.cancel("too late")

    with pytest.raises(Cancelled):
        panda.go_home(token=token, report=lambda **_: None)


def test_a_robot_that_is_off_does_nothing() -> None:
    with pytest.raises(SkillFailed, check=phrases.because("switched_off")):
        ask(open_panda().go_home)


def test_a_reset_puts_everything_back_and_time_goes_on(panda) -> None:
    before = panda.state()
    ask(panda.place, "red_cube", "left_bin")
    ask(panda.grasp, "green_cube")
    time_s = panda.time_s

    panda.reset()

    after = panda.state()
    assert {**after, "time": 0.0} == {**before, "time": 0.0}
    assert after["held"] is None
    panda.advance(0.1)
    assert panda.time_s > time_s


def test_numbers_that_break_are_put_back_and_the_errand_fails(held_panda) -> None:
    carry_out(held_panda, held_panda.place, "red_cube", "left_bin")
    asked = HeldSkill(held_panda, held_panda.move_to, 0.4, 0.3, 0.2)
    asked.until(moving(held_panda, "moving"))

    with held_panda.world.lock:
        held_panda.world.data.qpos[3] = float("nan")

    error = asked.end()
    assert isinstance(error, SkillFailed)
    assert "physics of my world broke" in str(error)
    assert held_panda.breaks == 1
    assert held_panda.describe_objects()["objects"]["red_cube"]["on"] == "table"
    carry_out(held_panda, held_panda.grasp, "red_cube")
    assert is_lifted(held_panda, "red_cube")


def test_the_state_says_what_is_going_on(held_panda) -> None:
    asked = HeldSkill(held_panda, held_panda.place, "red_cube", "left_bin")
    asked.until(moving(held_panda, "reaching"))
    early = held_panda.state()
    asked.until(moving(held_panda, "taking"))
    late = held_panda.state()
    asked.end()

    assert json.loads(json.dumps(early)) == early
    assert early["name"] == "robot-panda"
    assert early["simulation"] == "physics"
    goal = early["goal"]
    assert (goal["skill"], goal["object"], goal["target"]) == ("place", "red_cube", "left_bin")
    assert 0 < goal["progress"] < late["goal"]["progress"] < 1
    assert late["held"] == "red_cube"
    assert late["gripper_width"] == pytest.approx(0.05, abs=0.002)
    assert asked.reports[-1]["progress"] > 0.8


def test_with_speed_zero_time_passes_only_when_asked(held_panda) -> None:
    asked = HeldSkill(held_panda, held_panda.go_home)
    assert held_panda.time_s == 0.0
    held_panda.advance(0.1)
    assert held_panda.time_s == pytest.approx(0.1)

    assert asked.end() is None
