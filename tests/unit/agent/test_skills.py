import math
from datetime import timedelta
from enum import Enum
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
        ({"room": "kitchen", "speed": "nan"}, "go.speed: got 'nan', expected a valid number"),
        ({"room": "kitchen", "speed": math.nan}, "go.speed: got nan, expected a finite number"),
        ({"room": "kitchen", "speed": "0.5"}, "go.speed: got '0.5', expected a valid number"),
        ({"room": "kitchen", "speed": True}, "go.speed: got True, expected a valid number"),
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


def test_who_only_asks_for_an_unknown_skill_gets_none_or_what_was_given_for_it():
    assert SkillSet([go]).get("fly") is None
    assert SkillSet([go]).get("fly", go) is go
    assert SkillSet([go]).get("go") is go


def test_a_name_is_given_only_once():
    with pytest.raises(InvalidValue, match="given only once"):
        SkillSet([go, go])


class Gait(Enum):
    WALK = "walk"
    RUN = "run"


@skill()
def dance(
    goal,
    steps: int = 2,
    aloud: bool = False,
    height: float | None = None,
    gait: Gait = Gait.WALK,
    to: tuple[float, float] = (0.0, 0.0),
    song: str = "",
    pause: timedelta = timedelta(),
):
    """Dance."""


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"steps": True}, "dance.steps"),
        ({"steps": 2.5}, "dance.steps"),
        ({"steps": "2"}, "dance.steps"),
        ({"aloud": 1}, "dance.aloud"),
        ({"aloud": "yes"}, "dance.aloud"),
        ({"height": True}, "dance.height"),
        ({"height": "1"}, "dance.height"),
        ({"to": ["1", 2]}, "dance.to.0"),
        ({"to": [True, 2]}, "dance.to.0"),
        ({"song": 3}, "dance.song"),
        ({"song": None}, "dance.song"),
        ({"gait": "fly"}, "dance.gait"),
        ({"song": b"bytes"}, "dance.arguments"),
        ({1: 2}, "dance.1"),
    ],
)
def test_a_value_of_another_type_is_no_value(arguments, field):
    with pytest.raises(InvalidValue) as refused:
        dance.validate(arguments)
    assert refused.value.field.startswith(field)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("height", 1e308),
        ("height", -1e17),
        ("steps", 10**400),
        ("steps", 2**53 + 2),
        ("to", [0, 1e300]),
    ],
)
def test_a_number_that_json_does_not_hold_exactly_is_refused_whatever_the_skill(argument, value):
    with pytest.raises(InvalidValue, match=f"dance.{argument}") as refused:
        dance.validate({argument: value})
    assert refused.value.expected


def test_what_json_says_is_what_a_skill_gets_in_its_own_types():
    given = {"steps": 3, "aloud": True, "height": 1, "gait": "run", "to": [1, 2.5], "pause": "PT2S"}
    checked = dance.validate(given)
    assert checked == {
        "steps": 3,
        "aloud": True,
        "height": 1.0,
        "gait": Gait.RUN,
        "to": (1.0, 2.5),
        "song": "",
        "pause": timedelta(seconds=2),
    }
    assert type(checked["height"]) is float


@pytest.mark.parametrize(
    ("said", "given"),
    [
        ({"steps": "2", "height": "1.5"}, {"steps": 2, "height": 1.5}),
        ({"aloud": "yes"}, {"aloud": True}),
        ({"gait": "run", "song": "2"}, {"gait": "run", "song": "2"}),
        ({"steps": "2.5"}, {"steps": "2.5"}),
        ({"flavour": "sweet"}, {"flavour": "sweet"}),
    ],
)
def test_words_become_the_values_that_an_argument_takes_where_they_can(said, given):
    assert dance.from_words(said) == given
