"""A robot is told what a place is called, drives away, and finds back; after a restart, too."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import phrases
import pytest
from held_time import HeldSkill, carry_out
from spoken_robot import SpokenRobot

from edgevox.agent.goals.goal import Goal
from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.robots.flat.diff_drive import DiffDriveRobot

CHARGER = (7.0, 1.2)
WORKSHOP = Path(__file__).parents[2] / "examples" / "own_world" / "workshop.yaml"
ROBOTS = ["robot-apartment", pytest.param("robot-irsim", marks=pytest.mark.long)]


@pytest.fixture
def talk(tmp_path: Path) -> Callable[..., SpokenRobot]:
    """Builds a robot whose places are in one folder, as often as it is asked."""
    return partial(SpokenRobot, tmp_path)


def away_m(robot: SpokenRobot, x_m: float, y_m: float) -> float:
    pose = robot.body.pose()
    return math.dist((x_m, y_m), (pose.x_m, pose.y_m))


@pytest.mark.parametrize("robot", ROBOTS)
def test_it_finds_back_to_a_place_that_it_was_told_the_name_of(talk, robot) -> None:
    with talk(robot) as one:
        one.say("go to x 7, y 1.2")
        assert one.say("remember this place as the charger") == (
            phrases.done("remember_place", name="charger")
        )
        assert one.say("store the current position as the bay") == (
            phrases.done("remember_place", name="bay")
        )
        one.say("go to the living room")
        assert away_m(one, *CHARGER) > 2.0

        assert one.say("go to the charger") == phrases.done("navigate_to", location="charger")

        assert away_m(one, *CHARGER) < 0.3
        assert set(one.told("source")) == {"template"}


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_place_is_there_after_a_restart_in_its_world_and_in_no_other(talk, robot) -> None:
    with talk(robot) as one:
        one.say("go to x 7, y 1.2", "call this the loading dock")
    with talk(robot, world=str(WORKSHOP)) as one:
        assert one.say("go to the loading dock").startswith("I do not know the room 'loading dock'")
    with talk(robot) as one:
        assert one.say("go to the loading dock") == phrases.done(
            "navigate_to", location="loading_dock"
        )
        assert away_m(one, *CHARGER) < 0.3


def test_it_forgets_and_tells_which_places_it_knows(talk) -> None:
    with talk() as one:
        one.say("this is the charging station")
        rooms = ["kitchen", "bedroom", "living_room", "office"]
        known = phrases.done("list_places", names=[*rooms, "charging_station"])
        assert one.say("which places do you know?") == known
        assert one.say("forget the charging station").endswith("?")
        assert one.say("yes") == phrases.done("forget_place", room="charging_station")
        assert one.say("which places do you know?") == phrases.done("list_places", names=rooms)
        assert one.say("go to the charging station").startswith("I do not know the room")
    with talk() as one:
        assert "charging station" not in one.say("which places do you know?")


def test_a_remembered_place_is_a_word_of_commands_too(talk) -> None:
    with talk() as one:
        assert one.command("navigate_to", room="charger").startswith(
            "I cannot do that: I do not know charger"
        )
        one.command("remember_place", name="charger")
        assert one.command("navigate_to", room="The Charger") == phrases.done(
            "navigate_to", location="charger"
        )


@pytest.mark.parametrize(
    ("sentence", "answer"),
    [
        ("call this place kitchen", phrases.why("place_of_the_map", place="kitchen")),
        ("call this place Küche", phrases.why("place_of_the_map", place="kitchen")),
        ("call this place a/b", phrases.why("place_name_wrong")),
        (f"call this place {'very ' * 9}long", phrases.why("place_name_long", limit="40")),
        ("call this place yes", phrases.why("place_name_reserved", name="yes")),
        ("forget the place kitchen", phrases.why("place_stays", place="kitchen")),
    ],
)
def test_what_cannot_be_is_answered_with_the_reason(talk, sentence, answer) -> None:
    with talk() as one:
        assert answer in one.say(sentence)
        assert one.body.place_memory.names() == ()


def test_a_second_place_of_a_name_is_refused_until_the_first_is_forgotten(talk) -> None:
    with talk() as one:
        one.say("call this place the charger", "go to the kitchen")
        assert "It has to be forgotten first" in one.say("call this place the charger")
        one.say("forget the charger", "yes")
        assert one.say("call this place the charger") == (
            phrases.done("remember_place", name="charger")
        )


def test_a_german_place_is_spoken_of_with_the_right_little_words(talk) -> None:
    with talk(language="de") as one:
        one.say("Merk dir diesen Ort als Ladestation.", "Fahr in die Küche.")
        one.say("Fahr zur Ladestation!")
        charger = {"language": "de", "room": "Ladestation"}
        going, there = (f("navigate_to", **charger) for f in (phrases.begins, phrases.done))
        assert one.said[-2:] == [going, there]
        assert "zur Ladestation" in going
        assert "an der Ladestation" in there


def test_it_remembers_no_place_while_it_moves(held_robot: DiffDriveRobot) -> None:
    remember = SkillSet(held_robot.skills)["remember_place"]
    goal = Goal(remember, {"name": "charger"}, turn=0, bus=Bus())
    drive = HeldSkill(held_robot, held_robot.drive_to, *CHARGER)

    with pytest.raises(SkillFailed) as before_it_moves:
        remember.function(goal, name="charger")
    drive.until(lambda: held_robot.velocity().linear_m_s > 0.2)
    with pytest.raises(SkillFailed) as on_the_way:
        remember.function(goal, name="charger")
    drive.end()
    carry_out(held_robot, held_robot.drive_to, *CHARGER)

    assert before_it_moves.value.reason.code == "place_while_moving"
    assert on_the_way.value.reason.code == "place_while_moving"
    while abs(held_robot.velocity().linear_m_s) > 0.01:
        held_robot.advance(0.1)
    assert remember.function(goal, name="charger")["frame"] == "map"


@pytest.mark.parametrize("robot", ROBOTS)
def test_it_goes_to_a_point_that_was_given_a_name_from_afar(talk, robot) -> None:
    with talk(robot) as one:
        before = away_m(one, *CHARGER)
        named = one.command("remember_place", name="charger", x=CHARGER[0], y=CHARGER[1])
        assert named == phrases.done("remember_place", name="charger")
        assert away_m(one, *CHARGER) == before > 2.0
        assert one.body.place_memory.find("charger").yaw is None

        assert one.say("go to the charger") == phrases.done("navigate_to", location="charger")

        assert away_m(one, *CHARGER) < 0.3
    with talk(robot) as one:
        assert one.body.place_memory.find("charger").x == CHARGER[0]


def test_a_point_may_be_named_while_it_drives(held_robot: DiffDriveRobot) -> None:
    remember = SkillSet(held_robot.skills)["remember_place"]
    drive = HeldSkill(held_robot, held_robot.drive_to, *CHARGER)
    drive.until(lambda: held_robot.velocity().linear_m_s > 0.2)

    told = remember.function(Goal(remember, {}, turn=0, bus=Bus()), name="shelf", x=2.0, y=3.0)

    drive.end()
    assert told == {"name": "shelf", "x": 2.0, "y": 3.0, "yaw": None, "frame": "map"}


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"name": "shelf", "x": 200.0, "y": 3.0}, "outside"),
        ({"name": "kitchen", "x": 2.0, "y": 3.0}, "place_of_the_map"),
        ({"name": "stop", "x": 2.0, "y": 3.0}, "place_name_reserved"),
        ({"name": "4", "x": 2.0, "y": 3.0}, "place_name_wrong"),
    ],
)
def test_a_point_or_a_name_that_cannot_be_is_refused(
    held_robot: DiffDriveRobot, arguments: dict[str, Any], code: str
) -> None:
    remember = SkillSet(held_robot.skills)["remember_place"]
    with pytest.raises(SkillFailed) as refused:
        remember.validate(arguments)
    assert refused.value.reason.code == code


@pytest.mark.parametrize("half", [{"x": 2.0}, {"y": 2.0}])
def test_half_a_point_is_none(held_robot: DiffDriveRobot, half: dict[str, float]) -> None:
    remember = SkillSet(held_robot.skills)["remember_place"]
    with pytest.raises(InvalidValue, match="remember_place"):
        remember.validate({"name": "shelf", **half})
