from typing import Annotated

import phrases
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.nlu import templates
from edgevox.agent.nlu.templates import MAX_CHARACTERS, Recogniser, RefusedCommand, Understood
from edgevox.agent.skills import Call, OneOf, SkillSet, skill

ROOMS = OneOf(("kitchen", "bedroom", "living_room"), {"fridge": "kitchen"})


@skill(templates=["[please|could you] (go|drive) to [the] {room} [please]"])
def navigate_to(goal, room: Annotated[str, ROOMS]):
    """Drive to a room."""


@skill(templates=["(go|drive) to [x] {x} [and] [y] {y}"])
def navigate_xy(goal, x: float, y: float):
    """Drive to a point."""


@skill(templates=["where are you"], moves=False)
def get_pose(goal):
    """Say where the robot is."""


@pytest.fixture(scope="module")
def recogniser():
    return Recogniser(SkillSet([navigate_to, navigate_xy, get_pose]))


def to(room):
    return Call("navigate_to", {"room": room})


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("go to kitchen", [to("kitchen")]),
        ("Could you drive to the Living Room, please?", [to("living_room")]),
        ("GO TO LIVING_ROOM!", [to("living_room")]),
        ("go to the fridge", [to("kitchen")]),
        ("go to x two point five y minus one", [Call("navigate_xy", {"x": 2.5, "y": -1.0})]),
        ("go to (2.5, -1)", [Call("navigate_xy", {"x": 2.5, "y": -1.0})]),
        ("go to x=3, y=4.5.", [Call("navigate_xy", {"x": 3.0, "y": 4.5})]),
        ("go to the bedroom, then where are you", [to("bedroom"), Call("get_pose")]),
        ("go to the bedroom and then go to the kitchen", [to("bedroom"), to("kitchen")]),
        ("go to the bedroom. Where are you?", [to("bedroom"), Call("get_pose")]),
    ],
)
def test_plain_commands_are_understood(recogniser, text, calls):
    assert recogniser.recognise(text) == Understood(tuple(calls))


def test_a_name_that_is_only_nearly_said_is_found_and_not_sure(recogniser):
    assert recogniser.recognise("go to the kichen") == Understood((to("kitchen"),), unsure=True)
    assert recogniser.recognise("go to the livingroom") == Understood((to("living_room"),))


KNOWN = "kitchen, bedroom and living room"
UNKNOWN = phrases.said("unknown_word", argument="room", said="garage", known=KNOWN)
MISSING = phrases.said("missing_word", argument="room", known=KNOWN)
NO_MOON = phrases.said("unknown_word", argument="room", said="moon", known=KNOWN)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("go to the garage", UNKNOWN),
        ("go to", MISSING),
        ("go to the", MISSING),
        (
            "go to the bedroom and then go to the moon",
            NO_MOON,
        ),
    ],
)
def test_a_missing_or_unknown_word_is_refused_by_name(recogniser, text, reason):
    found = recogniser.recognise(text)
    assert isinstance(found, RefusedCommand)
    assert found.reason.startswith(reason)


@pytest.mark.parametrize(
    "text",
    [
        "hello",
        "",
        "I am hungry",
        "go to the place where I sleep",
        "go to the kitchen and then dance",
        "go to x 99 y",
        "go to the kitchen " * 50,
    ],
)
def test_anything_else_is_left_to_the_model(recogniser, text):
    assert recogniser.recognise(text) is None


@given(st.text(max_size=MAX_CHARACTERS + 10))
def test_any_text_gives_valid_calls_or_none(text):
    skills = SkillSet([navigate_to, navigate_xy, get_pose])
    found = Recogniser(skills).recognise("go to " + text)
    if isinstance(found, Understood):
        for call in found.calls:
            skills[call.skill].validate(call.arguments)


def test_a_template_is_read_once_however_many_recognisers_have_it(monkeypatch):
    skills = SkillSet([navigate_to, navigate_xy, get_pose])
    Recogniser(skills, "de")
    monkeypatch.setattr(templates, "parse_sentence", None)

    assert Recogniser(skills, "de").recognise("go to the kitchen") == Understood((to("kitchen"),))
    with pytest.raises(TypeError):
        Recogniser(SkillSet([skill(templates=["where am I"])(get_pose.function)]), "de")


def test_a_template_with_many_optional_values_takes_no_longer_for_words_it_does_not_know():
    part = "[[(with|and)] [(a|an)] ({milk}|{sugar}|{size}|{roast}|{shots})"
    some = OneOf(("small", "dark roast", "double shot", "soy milk", "brown sugar"))

    @skill(templates=["[(give|make) me] [a] {drink} " + 5 * part + 5 * "]"], moves=False)
    def order(
        goal,
        drink: Annotated[str, OneOf(("mocha", "latte"))],
        milk: Annotated[str, some] = "soy milk",
        sugar: Annotated[str, some] = "brown sugar",
        size: Annotated[str, some] = "small",
        roast: Annotated[str, some] = "dark roast",
        shots: Annotated[str, some] = "double shot",
    ):
        """Make a drink."""

    orders = Recogniser(SkillSet([order]))

    assert orders.recognise("make me a latte with brown sugar") is not None
    assert orders.recognise("brew a small single shot marker with a bit of something or so") is None
