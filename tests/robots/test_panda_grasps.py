"""The Panda takes cubes in its hand, by friction alone, and puts them where they belong."""

import itertools
from collections.abc import Iterator

import phrases
import pytest
from held_time import STEP_S, HeldSkill, carry_out
from panda_table import ask, is_lifted, moving, open_panda, put_cube

from edgevox.agent.skills import SkillFailed
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.table import BINS, CUBES


@pytest.fixture
def panda() -> Iterator[PandaRobot]:
    with open_panda() as robot:
        yield robot


@pytest.fixture
def held_panda(held) -> PandaRobot:
    """Its time stands still until it is told."""
    return held(open_panda)


def is_in(robot: PandaRobot, name: str, target: str) -> bool:
    place = robot.state()["objects"][name]
    return BINS[target].contains(place["x"], place["y"]) and place["z"] < 0.04


@pytest.mark.parametrize("many", [len(CUBES), pytest.param(20, marks=pytest.mark.long)])
def test_cubes_at_random_places_are_grasped_lifted_and_put_into_a_bin(many) -> None:
    done: list[str] = []
    targets = itertools.cycle(BINS)
    for seed in itertools.count(1):
        with open_panda(seed) as robot:
            for name in CUBES:
                target = next(targets)
                ask(robot.grasp, name)
                assert is_lifted(robot, name), (seed, name)
                ask(robot.place, None, target)
                assert is_in(robot, name, target), (seed, name)
                done.append(name)
                if len(done) == many:
                    return


@pytest.mark.long
def test_the_same_seed_gives_the_same_run() -> None:
    ends = []
    for _ in range(2):
        with open_panda(seed=3) as robot:
            ask(robot.place, "green_cube", "right_bin")
            ends.append((robot.state(), robot.end_effector()))

    assert ends[0] == ends[1]


def test_where_time_is_held_a_run_is_the_same_step_by_step(held) -> None:
    runs = []
    for _ in range(2):
        panda = held(open_panda, 3)
        going = HeldSkill(panda, panda.place, "green_cube", "right_bin")
        states = [panda.state()]
        while states[-1]["goal"] is not None:
            panda.advance(STEP_S)
            states.append(panda.state())
        assert going.ended() is None
        runs.append(states)

    assert len(runs[0]) > 100
    assert runs[0] == runs[1]


def test_another_seed_puts_the_cubes_elsewhere() -> None:
    places = [open_panda(seed).state()["objects"] for seed in (0, 1, 2)]

    assert places[0] != places[1] != places[2]


def test_three_cubes_make_a_tower(panda) -> None:
    ask(panda.place, "red_cube", "green_cube")
    ask(panda.place, "blue_cube", "red_cube")

    places = panda.describe_objects()["objects"]
    assert [places[name]["on"] for name in CUBES] == ["green_cube", "table", "red_cube"]
    assert places["blue_cube"]["z"] == pytest.approx(0.125, abs=0.002)


def test_what_is_put_down_lies_within_a_centimetre(panda) -> None:
    ask(panda.place, "red_cube", "left_bin")

    place = panda.state()["objects"]["red_cube"]
    assert (place["x"], place["y"]) == pytest.approx(BINS["left_bin"].center, abs=0.01)


def test_two_cubes_share_a_bin_and_come_out_again(panda) -> None:
    ask(panda.place, "red_cube", "right_bin")
    ask(panda.place, "blue_cube", "right_bin")
    ask(panda.place, "red_cube", "table")

    where = {name: one["on"] for name, one in panda.describe_objects()["objects"].items()}
    assert where == {"red_cube": "table", "green_cube": "table", "blue_cube": "right_bin"}


def test_a_cube_that_is_moved_while_the_hand_comes_is_grasped_where_it_is(held_panda) -> None:
    asked = HeldSkill(held_panda, held_panda.grasp, "red_cube")
    asked.until(moving(held_panda, "reaching"))
    put_cube(held_panda, "red_cube", 0.56, 0.06, 0.025)

    assert asked.end() is None
    assert is_lifted(held_panda, "red_cube")
    assert held_panda.state()["pose"]["x"] == pytest.approx(0.56, abs=0.01)


def test_a_cube_that_slips_out_of_the_hand_is_noticed(held_panda) -> None:
    carry_out(held_panda, held_panda.grasp, "red_cube")
    asked = HeldSkill(held_panda, held_panda.place, "red_cube", "left_bin")
    asked.until(moving(held_panda, "taking"))
    put_cube(held_panda, "red_cube", 0.6, 0.0, 0.025)

    error = asked.end()
    assert isinstance(error, SkillFailed)
    assert phrases.because("dropped", thing="red cube")(error)
    assert held_panda.state()["held"] is None


def test_a_cube_that_is_taken_away_is_not_grasped_for_ever(held_panda) -> None:
    asked = HeldSkill(held_panda, held_panda.grasp, "red_cube")
    asked.until(moving(held_panda, "reaching"))
    put_cube(held_panda, "red_cube", 0.5, 0.0, -0.6)

    assert isinstance(asked.end(), SkillFailed)


def test_letting_go_drops_what_is_held(panda) -> None:
    ask(panda.grasp, "blue_cube")

    assert ask(panda.release) == "blue_cube"
    assert panda.state()["held"] is None
    assert panda.state()["gripper_width"] == pytest.approx(0.08, abs=0.002)
    panda.advance(0.5)
    assert panda.state()["objects"]["blue_cube"]["z"] < 0.04


def test_home_keeps_what_is_held(panda) -> None:
    ask(panda.grasp, "green_cube")
    ask(panda.go_home)

    assert is_lifted(panda, "green_cube")
    pose = panda.state()["pose"]
    assert (pose["x"], pose["y"], pose["z"]) == pytest.approx((0.307, 0.0, 0.487), abs=0.01)
