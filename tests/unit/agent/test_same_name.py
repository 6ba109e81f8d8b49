"""Two names are the same or not by one rule, in every language and however they are written."""

from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.skills import skill
from edgevox.agent.skills.skill import OneOf
from edgevox.agent.text.same_name import is_same_name, name_form, names_meant, names_near
from edgevox.core.errors import InvalidValue
from edgevox.robots.world.load import parse_world
from edgevox.ros2.external.settings import parse_locations

SAME = [
    ("Kitchen", "kitchen"), ("kítchen", "kitchen"), ("kit_chen", "kitchen"),
    ("kit-chen", "kitchen"), ("kit chen", "kitchen"), ("kit\u200bchen", "kitchen"),
    ("kit\u00adchen", "kitchen"), ("kit\u0441hen", "kitchen"), ("\uff2bitchen", "kitchen"),
    ("the my kitchen", "kitchen"), ("kitchens", "kitchen"), ("kitchen's", "kitchen"),
    ("Bed_Room", "bedroom"), ("lobbies", "lobby"), ("die Küche", "kuche"), ("Küchen", "Küche"),
    ("meiner Küche", "Küche"), ("l'entrée", "entree"), ("ma cuisine", "cuisine"),
    ("un'entrata", "entrata"), ("cucine", "cucina"), ("o escritório", "escritorio"),
    ("las cocinas", "cocina"), ("salas de estar", "sala de estar"), ("'t kantoor", "kantoor"),
    ("moja kuchnia", "kuchnia"), ("кухни", "кухня"), ("моя кухня", "кухня"),
    ("mutfaklar", "mutfak"), ("benim mutfak", "mutfak"), ("المطبخ", "مطبخ"),
    ("मेरी रसोई", "रसोई"), ("dapur saya", "dapur"), ("dapur-dapur", "dapur"),
    ("nhà bếp của tôi", "nhà bếp"), ("我的厨房", "厨房"), ("私の台所", "台所"), ("do_ck", "dock"),
    ("la-b", "lab"), ("ʙᴇᴅʀᴏᴏᴍ", "bedroom"), ("きっちん", "キッチン"), ("مَطْبَخ", "مطبخ"),
]  # fmt: skip
DIFFERENT = [
    ("shelf A", "shelf B"), ("Gate A1", "Gate I1"), ("A 1", "O 1"), ("Maria", "Mario"),
    ("bed", "bedroom"), ("kitchen 2", "kitchen"), ("porta", "porto"), ("dock", "duck"),
    ("office", "officer"),
]  # fmt: skip


@pytest.mark.parametrize(("one", "other"), SAME)
def test_what_surrounds_or_spells_a_name_makes_no_other(one, other) -> None:
    assert is_same_name(one, other)
    assert is_same_name(other, one)


@pytest.mark.parametrize(("one", "other"), DIFFERENT)
def test_names_of_two_things_stay_apart(one, other) -> None:
    assert not is_same_name(one, other)
    assert not is_same_name(other, one)


@given(st.text(max_size=40))
def test_any_text_has_one_form_which_is_that_of_itself(text: str) -> None:
    form = name_form(text)
    assert name_form(text.upper().lower()) == name_form(text.lower())
    assert " " not in form
    assert not form or is_same_name(text, text)


@pytest.mark.parametrize(("name", "near"), [("kichen", True), ("dock 2", False), ("duck", False)])
def test_a_slip_is_near_a_name_and_a_number_is_none(name, near) -> None:
    assert bool(names_near(name, {"kitchen": "kitchen", "dock": "dock"})) is near


def test_a_name_of_the_same_form_counts_before_its_singular() -> None:
    known = {"office": "office", "offices": "offices"}
    assert names_meant("The Offices", known) == ("offices",)
    assert names_meant("the office", known) == ("office",)


def test_a_call_takes_a_word_by_its_form_and_no_plural() -> None:
    @skill()
    def go(goal, room: Annotated[str, OneOf(("living_room", "kitchen"))]):
        """Go there."""

    assert go.validate({"room": "The Living-Room"}) == {"room": "living_room"}
    with pytest.raises(InvalidValue):
        go.validate({"room": "kitchens"})


@pytest.mark.parametrize("other", ["the dock", "Dóck", "d-ock"])
def test_no_two_places_of_a_file_have_one_name(other) -> None:
    with pytest.raises(InvalidValue, match="a name that 'dock' does not have"):
        parse_locations(f"dock: {{x: 1, y: 2}}\n{other}: {{x: 2, y: 2}}", "home.yaml")


def test_no_two_rooms_of_a_world_have_one_name() -> None:
    room = "{outline: [[0, 0], [9, 0], [9, 9]]}"
    text = f"""
robot: {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [1, 1, 0]}}
custom: {{edgevox: {{rooms: {{bedroom: {room}, Bed_Room: {room}}}}}}}
"""
    with pytest.raises(InvalidValue, match="a name that 'bedroom' does not have"):
        parse_world(text, "home.yaml")
