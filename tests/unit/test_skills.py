from typing import Annotated

import pytest
from pydantic import Field

from edgevox.agent.skills import OneOf, SkillSet, UnknownSkill, skill
from edgevox.core.errors import InvalidValue

ROOMS = OneOf(("kitchen", "living_room"), {"fridge": "kitchen"})


@skill(templates=["go to [the] {room}"], says="Going to the {room}.")
def go(goal, room: Annotated[str, ROOMS], speed: Annotated[float, Field(gt=0, le=1)] = 0.5):
    """Drive to a room.

    More that a schema does not need.
    """


def test_a_function_gives_its_skill_a_name_a_description_and_a_schema():
    assert go.name == "go"
    assert go.description == "Drive to a room."
    assert go.schema["properties"]["room"]["enum"] == ["kitchen", "living_room"]
    assert go.schema["required"] == ["room"]


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("kitchen", "kitchen"),
        ("Kitchen", "kitchen"),
        ("the living room", "living_room"),
        ("living_room", "living_room"),
        ("Fridge", "kitchen"),
    ],
)
def test_one_of_takes_a_word_as_people_say_it(said, meant):
    assert go.validate({"room": said}) == {"room": meant, "speed": 0.5}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"room": "garage"}, "go.room: got 'garage', expected 'kitchen' or 'living_room'"),
        ({"room": 3}, "go.room: got 3, expected 'kitchen' or 'living_room'"),
        ({}, "go.room: got None, expected a value"),
        ({"room": "kitchen", "speed": 2}, "go.speed: got 2, expected less than or equal to 1"),
        ({"room": "kitchen", "speed": "nan"}, "go.speed: got 'nan', expected a finite number"),
        ({"room": "kitchen", "color": 1}, "go.color: got 1, expected no such argument"),
    ],
)
def test_a_wrong_argument_is_refused_by_name(arguments, message):
    with pytest.raises(InvalidValue) as refused:
        go.validate(arguments)
    assert str(refused.value) == message


def test_an_unknown_skill_is_refused_with_the_names_that_exist():
    with pytest.raises(UnknownSkill, match="skill: got 'fly', expected one of go"):
        SkillSet([go])["fly"]


def test_a_name_is_given_only_once():
    with pytest.raises(InvalidValue, match="given only once"):
        SkillSet([go, go])
