"""What the Panda does not do, and what it says then."""

import math
import re
from collections.abc import Iterator

import phrases
import pytest
from panda_table import ask, open_panda, put_cube

from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import InvalidValue
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.workcell import Workcell

POINT = r"x (-?\d\.\d\d), y (-?\d\.\d\d), z (-?\d\.\d\d)\.?$"


@pytest.fixture
def panda() -> Iterator[PandaRobot]:
    with open_panda() as robot:
        yield robot


@pytest.mark.parametrize(
    ("point", "blocked"),
    [
        ((1.5, 0.1, 0.3), ""),
        ((0.3, 0.2, 2.0), ""),
        ((-9.0, 5.0, 0.5), ""),
        ((0.5, 0.0, -0.2), "would_touch"),
        ((0.0, 0.0, 0.1), "would_touch_itself"),
    ],
)
def test_a_point_that_cannot_be_reached_is_refused_with_the_nearest_that_can(
    panda, point, blocked
) -> None:
    with pytest.raises(SkillFailed) as refused:
        ask(panda.move_to, *point)
    why = refused.value.reason
    assert why.code == ("blocked" if blocked else "beyond")
    assert not blocked or why.values["why"].code == blocked

    found = re.search(POINT, why.values["nearest"])
    assert found
    nearest = tuple(float(number) for number in found.groups())
    assert math.dist(nearest, point) < math.dist((0.307, 0.0, 0.487), point)
    ask(panda.move_to, *nearest)
    hand = panda.end_effector()
    assert (hand.x_m, hand.y_m, hand.z_m) == pytest.approx(nearest, abs=0.01)


def test_the_nearest_point_is_at_the_edge_of_the_reach(panda) -> None:
    with pytest.raises(SkillFailed) as refused:
        ask(panda.move_to, 1.5, 0.0, 0.3)
    assert refused.value.reason.values["nearest"].startswith("x 0.9")


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_point_that_is_no_point_is_refused(panda, value) -> None:
    with pytest.raises(InvalidValue, match="y"):
        ask(panda.move_to, 0.4, value, 0.3)


def test_with_an_empty_hand_there_is_nothing_to_put_down(panda) -> None:
    with pytest.raises(SkillFailed, check=phrases.because("holds_nothing")):
        ask(panda.place, None, "left_bin")


def test_a_full_hand_takes_nothing_more(panda) -> None:
    ask(panda.grasp, "red_cube")

    with pytest.raises(SkillFailed, check=phrases.because("held_already", thing="red cube")):
        ask(panda.grasp, "red_cube")
    with pytest.raises(SkillFailed, check=phrases.because("hand_full", thing="red cube")):
        ask(panda.grasp, "blue_cube")
    with pytest.raises(SkillFailed, check=phrases.because("hand_full")):
        ask(panda.place, "blue_cube", "left_bin")
    assert panda.state()["held"] == "red_cube"


def test_a_cube_under_another_stays_there(panda) -> None:
    put_cube(panda, "green_cube", 0.52, 0.0, 0.075)
    panda.advance(0.3)

    with pytest.raises(
        SkillFailed, check=phrases.because("stands_on", upper="green cube", thing="red cube")
    ):
        ask(panda.grasp, "red_cube")
    with pytest.raises(SkillFailed, check=phrases.because("occupied", thing="red cube")):
        ask(panda.place, "blue_cube", "red_cube")


def test_a_cube_does_not_stand_on_itself(panda) -> None:
    with pytest.raises(SkillFailed, check=phrases.because("on_itself", thing="red cube")):
        ask(panda.place, "red_cube", "red_cube")


def test_a_cube_on_the_floor_is_left_there(panda) -> None:
    put_cube(panda, "red_cube", 1.2, 0.0, -0.69)
    panda.advance(0.3)

    with pytest.raises(SkillFailed, check=phrases.because("out_of_reach", thing="red cube")):
        ask(panda.grasp, "red_cube")


def test_a_cube_out_of_reach_is_named_as_such(panda) -> None:
    put_cube(panda, "red_cube", 0.82, 0.55, 0.025)
    panda.advance(0.3)

    with pytest.raises(SkillFailed, check=phrases.because("thing_too_far", thing="red cube")):
        ask(panda.grasp, "red_cube")


def test_words_that_name_nothing_are_refused_by_the_skill() -> None:
    skills = {one.name: one for one in open_panda().skills}

    with pytest.raises(InvalidValue, match="grasp.object"):
        skills["grasp"].validate({"object": "banana"})
    with pytest.raises(InvalidValue, match="place.target"):
        skills["place"].validate({"object": "red_cube", "target": "moon"})


def test_a_file_that_is_no_panda_is_refused(tmp_path) -> None:
    other = tmp_path / "other.xml"
    other.write_text("<mujoco><worldbody/></mujoco>")

    with pytest.raises(InvalidValue, match="a Franka Panda with its gripper"):
        Workcell(other)
    with pytest.raises(InvalidValue, match="a readable MJCF"):
        Workcell(tmp_path / "missing.xml")
