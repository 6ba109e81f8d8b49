"""What a place may be called, and what is said of a name that it may not have."""

import phrases
import pytest

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.core.languages import LANGUAGES
from edgevox.core.transforms import Pose2D
from edgevox.robots.names import LONGEST_PLACE
from edgevox.robots.places.memory import MOST_PLACES, PlaceMemory

HERE = Pose2D(1.25, -2.0, 1.5)


@pytest.fixture
def memory():
    one = PlaceMemory("flat", OneOf(("kitchen", "living_room"), {"fridge": "kitchen"}))
    one.remember("charger", HERE, "map")
    return one


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("", "place_name_wrong"),
        (" ", "place_name_wrong"),
        ("a/b", "place_name_wrong"),
        ("../../etc/passwd", "place_name_wrong"),
        ("C:\\dock", "place_name_wrong"),
        ("dock.json", "place_name_wrong"),
        ("dock\n", "place_name_wrong"),
        ("do\x00ck", "place_name_wrong"),
        ("dock\u202e", "place_name_wrong"),
        ("  dock", "place_name_wrong"),
        ("7", "place_name_wrong"),
        ("\N{ROBOT FACE}", "place_name_wrong"),
        ("x" * (LONGEST_PLACE + 1), "place_name_long"),
        ("x" * 100_000, "place_name_long"),
        ("stop", "place_name_reserved"),
        ("the stop", "place_name_reserved"),
        ("Halt", "place_name_reserved"),
        ("yes", "place_name_reserved"),
        ("nein", "place_name_reserved"),
        ("cancel", "place_name_reserved"),
        ("here", "place_name_reserved"),
        ("停", "place_name_reserved"),
        ("kitchen", "place_of_the_map"),
        ("KITCHEN", "place_of_the_map"),
        ("living room", "place_of_the_map"),
        ("fridge", "place_of_the_map"),
        ("Küche", "place_of_the_map"),
        ("台所", "place_of_the_map"),
        ("charger", "place_known"),
        ("Charger", "place_known"),
    ],
)
def test_a_name_that_cannot_be_is_refused_with_its_code(memory, name, code):
    with pytest.raises(SkillFailed) as refused:
        memory.remember(name, HERE, "map")

    assert refused.value.reason.code == code
    assert memory.names() == ("charger",)
    for language in LANGUAGES:
        told = phrasebook(language).failure(refused.value.reason)
        assert not set("{}") & set(told)
        assert len(told) < 250


@pytest.mark.parametrize(
    "name", ["loading dock", "Laderampe", "bus stop", "dock 2", "Grandma's bed", "ladder", "充电站"]
)
def test_an_ordinary_name_is_taken(memory, name):
    memory.remember(name, HERE, "map")

    assert memory.names() == ("charger", name)


def test_a_taken_name_says_where_that_place_is_and_what_to_do(memory):
    with pytest.raises(SkillFailed) as refused:
        memory.check("charger")

    assert phrases.because("place_known", place="charger", x="1.2", y="-2.0")(refused.value)


@pytest.mark.parametrize(
    ("name", "code"), [("kitchen", "place_stays"), ("charging bay", "place_unknown")]
)
def test_what_was_never_remembered_cannot_be_forgotten(memory, name, code):
    with pytest.raises(SkillFailed) as refused:
        memory.forget(name)

    assert refused.value.reason.code == code


def test_there_is_a_most_of_places(memory):
    for number in range(1, MOST_PLACES):
        memory.remember(f"place {number}", HERE, "map")
    with pytest.raises(SkillFailed) as refused:
        memory.remember("one more", HERE, "map")

    assert refused.value.reason.code == "places_full"
    memory.forget("place 7")
    memory.remember("one more", HERE, "map")
    assert len(memory.names()) == MOST_PLACES
