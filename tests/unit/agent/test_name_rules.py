"""No place, room, thing or skill takes a name that people need for something else."""

import re
from itertools import islice
from pathlib import Path
from typing import Annotated

import pytest
import yaml
from few_languages import few
from hassil.parse_expression import parse_sentence
from hassil.sample import sample_expression
from support.bodies import BODIES

from edgevox.agent.phrases import name_rules
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.name_rules import TemplateScanner, check_name, check_skills
from edgevox.agent.skills import OneOf, skill
from edgevox.agent.text.spelling import key
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.robots.names import read_name
from edgevox.robots.world.load import load_world, parse_world
from edgevox.ros2.external.settings import parse_locations

ROOT = Path(__file__).parents[3]
STOPPING = {
    "en": "stop", "es": "alto", "fr": "arrêtez", "hi": "रुको", "it": "fermati", "ja": "止まれ",
    "pt": "pare", "zh": "停下", "vi": "dừng lại", "de": "halt", "nl": "sta stil", "pl": "stój",
    "ru": "стой", "tr": "dur", "ar": "توقف", "id": "berhenti",
}  # fmt: skip
YES = {
    "en": "yes", "es": "sí", "fr": "oui", "hi": "हाँ", "it": "sì", "ja": "はい", "pt": "sim",
    "zh": "是", "vi": "vâng", "de": "ja", "nl": "ja", "pl": "tak", "ru": "да", "tr": "evet",
    "ar": "نعم", "id": "ya",
}  # fmt: skip
WAIT = {
    "en": "wait", "es": "espera", "fr": "attends", "it": "aspetta", "ja": "待って",
    "pt": "aguarde", "de": "warte", "nl": "wacht", "pl": "czekaj", "ru": "подожди",
    "tr": "bekle", "ar": "انتظر", "id": "tunggu", "hi": "यहीं रहो", "vi": "đứng yên", "zh": "等等",
}  # fmt: skip
PLACES = (
    "kitchen", "front door", "living_room", "dock", "charger", "home", "meeting room 2", "lobby",
    "loading bay", "shelf B", "workbench", "Küche", "Werkstatt", "Büro", "Flur", "cuisine",
    "salle de bain", "entrepôt", "cocina", "oficina", "almacén", "cucina", "ufficio", "magazzino",
    "cozinha", "escritório", "armazém", "keuken", "magazijn", "kuchnia", "biuro", "magazyn",
    "кухня", "склад", "кабинет", "mutfak", "ofis", "depo", "nhà bếp", "phòng khách", "dapur",
    "gudang", "मेज़", "रसोई", "مطبخ", "مكتب", "台所", "倉庫", "厨房", "仓库", "Station 3", "Tor A",
)  # fmt: skip


def refused(name: str) -> InvalidValue:
    with pytest.raises(InvalidValue) as caught:
        read_name("home.yaml", name)
    return caught.value


@pytest.mark.parametrize("name", ["{}", "{} 2", "the {}", "{}_room"])
def test_a_name_with_a_stop_word_of_any_language_is_refused_and_says_which(name) -> None:
    for code, language in LANGUAGES.items():
        text = name.format(STOPPING[code])
        if not language.spaced:
            text = text.replace("_", "")
        error = refused(text)

        assert (error.field, error.value) == ("home.yaml", text)
        assert "which stops the robot in" in error.expected or "people say" in error.expected


@pytest.mark.parametrize("words", [YES, WAIT], ids=["yes", "wait"])
def test_a_name_that_people_answer_or_halt_with_is_refused_with_its_language(words) -> None:
    for code in LANGUAGES:
        for name in (words[code], words[code].upper()):
            expected = refused(name).expected
            assert "to a robot in" in expected or "stops the" in expected


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_language_keeps_its_answers_for_itself(code) -> None:
    reserved = phrasebook(code).hearing.reserved

    assert len(reserved) >= 12
    for word in reserved:
        with pytest.raises(InvalidValue):
            check_name("place", word)


def test_the_error_names_the_field_the_name_and_the_language() -> None:
    error = refused("Stop")
    assert str(error) == (
        "home.yaml: got 'Stop', expected a name without 'stop', which stops the robot in English"
    )
    error = refused("да")
    assert "people say 'да' to a robot in Russian" in error.expected


def test_a_usual_name_of_any_language_is_free() -> None:
    assert [read_name("home.yaml", name) for name in PLACES] == [*PLACES]


@pytest.mark.parametrize(
    "name", ["k" * 65, "", " kitchen", "1st floor", "a\nb", "[a]", "a\u200bb", "\u094dk", 3]
)
def test_a_name_is_short_and_can_be_said(name) -> None:
    with pytest.raises(InvalidValue, match="a name of at most 64 letters"):
        read_name("home.yaml", name)


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("stop: {x: 1, y: 2}", "home.yaml:1: stop"),
        ("dock: {x: 1, y: 2, aliases: [home, halt]}", "home.yaml:1: dock.aliases.1"),
        ("dock: {x: 1, y: 2, aliases: ['yes']}", "home.yaml:1: dock.aliases.0"),
    ],
)
def test_a_location_is_not_called_so(text, field) -> None:
    with pytest.raises(InvalidValue) as caught:
        parse_locations(text, "home.yaml")
    assert caught.value.field == field


WORLD = """
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0]}
obstacle: [{name: %s, state: [5, 5, 0], shape: {name: circle, radius: 0.2}}]
custom: {edgevox: {rooms: {%s: {outline: [[0, 0], [9, 0], [9, 9]], aliases: [%s]}}}}
"""


@pytest.mark.parametrize(
    ("names", "field"),
    [
        (("sofa", "stop", "den"), "home.yaml:4: custom.edgevox.rooms.stop"),
        (("sofa", "den", "abort"), "home.yaml:4: custom.edgevox.rooms.den.aliases.0"),
        (("sofa", "den", "'a\\nb'"), "home.yaml:4: custom.edgevox.rooms.den.aliases.0"),
        (("stop", "den", "cave"), "home.yaml:3: obstacle.0.name"),
        (("s" * 65, "den", "cave"), "home.yaml:3: obstacle.0.name"),
    ],
)
def test_nor_a_room_nor_a_thing_of_a_world(names, field) -> None:
    parse_world(WORLD % ("sofa", "den", "cave"), "home.yaml")
    with pytest.raises(InvalidValue) as caught:
        parse_world(WORLD % names, "home.yaml")
    assert caught.value.field == field


@pytest.mark.parametrize("body", BODIES)
def test_the_skills_and_things_of_our_own_bodies_are_free(body) -> None:
    check_skills(BODIES[body].values())


def test_a_strangers_skill_takes_neither_a_stop_word_nor_an_answer() -> None:
    @skill()
    def emergency_stop(goal):
        """Not for saying."""

    @skill()
    def cancel(goal):
        """Nor this."""

    @skill()
    def paint(goal, colour: Annotated[str, OneOf(("red", "blue"), {"halt": "red"})]):
        """Paint."""

    for one, field in ((emergency_stop, "skill"), (cancel, "skill"), (paint, "paint.colour")):
        with pytest.raises(InvalidValue) as caught:
            check_skills([one])
        assert caught.value.field == field


def test_our_own_worlds_and_locations_are_free() -> None:
    load_world()
    for file in (ROOT / "examples").rglob("*.yaml"):
        text = file.read_text("utf-8")
        read = yaml.safe_load(text)
        if "robot" in read:
            parse_world(text, file.name)
        elif all(isinstance(one, dict) and "x" in one for one in read.values()):
            parse_locations(text, file.name)


@pytest.mark.parametrize("code", few(LANGUAGES))
def test_what_a_template_must_hold_is_found_without_compiling_it(code) -> None:
    book = phrasebook(code)
    scanner = TemplateScanner(book.rules, spaced=book.hearing.spaced)
    rules = {name: parse_sentence(rule) for name, rule in book.rules.items()}
    for one in book.skills.values():
        for template in one.templates:
            its = scanner.scan(template)
            parsed = parse_sentence(template).expression
            samples = sample_expression(parsed, expansion_rules=rules, expand_lists=False)
            for said in islice(samples, 20):
                text = key(re.sub(r"\{[^}]*\}", " ", said))
                words = text.split() if book.hearing.spaced else text.replace(" ", "")
                assert its.words.issuperset(words), (template, said)
                assert all(not one.isdisjoint(words) for one in its.needs), (template, said)


def test_names_of_places_are_no_sentences_without_a_template_compiled(monkeypatch) -> None:
    """A robot that has remembered hundreds of places is ready at once."""

    def compiled(*_: object, **__: object) -> None:
        raise AssertionError("a template was compiled")

    monkeypatch.setattr(name_rules, "parse_sentence", compiled)

    for name in ("red shelf", "north rack", "Annas Schreibtisch", "étagère bleue", "倉庫", "Tor 4"):
        assert not name_rules.is_sentence(name, {"hangar": "hangar"})
