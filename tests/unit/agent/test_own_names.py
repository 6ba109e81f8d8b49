"""What a stranger's file calls its rooms, places and values is said and understood."""

from typing import Annotated

import pytest
from support.conversation import Talk

from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.skills import (
    Call,
    OneOf,
    OwnName,
    Skill,
    SkillFailed,
    SkillPhrases,
    SkillSet,
    skill,
)
from edgevox.core.agent_events import ToolCalled
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.robots.flat.planner import PathPlanner
from edgevox.robots.navigation import LOCATION, navigation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.world.load import parse_world
from edgevox.ros2.external.settings import parse_locations

ROBOT = "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0]}\n"
ROOM = "outline: [[0, 0], [4, 0], [4, 5], [0, 5]]"
PLACES = """
pharmacy:
  x: 1.0
  y: 2.0
  names:
    de: [die Apotheke, Arzneiausgabe]
    fr: {name: la pharmacie, to: dans la pharmacie}
    es: farmacia
    it: l'apoteca
    ru: {name: аптека, to: в аптеку, at: в аптеке, heard: [аптеку]}
    ja: 薬局
    en: the chemist
cinema: {x: 3.0, y: 4.0, aliases: [movies], names: {de: Kino, fr: le cinéma}}
kitchen: {x: 5.0, y: 6.0, names: {de: die Kombüse}}
"""
LOCATIONS = parse_locations(PLACES, "ward.yaml")
NAMES = {name: one.names for name, one in LOCATIONS.items()}


class Ward:
    """A body that knows these places, and is there at once."""

    def __init__(self) -> None:
        self.places = {name: (one.x_m, one.y_m) for name, one in LOCATIONS.items()}
        aliases = {said: name for name, one in LOCATIONS.items() for said in one.aliases}
        self.memory = PlaceMemory("ward", OneOf(tuple(self.places), aliases, names=NAMES))
        self.skills = SkillSet(
            navigation_skills(self, aliases=aliases, word=LOCATION, memory=self.memory, names=NAMES)
        )

    def drive_to(self, x_m, y_m, *, token, report):
        """It is there."""

    def place_at(self, x_m, y_m):
        return next((name for name, point in self.places.items() if point[0] == x_m), None)


WARD = Ward()
GO = WARD.skills["navigate_to"]


@pytest.mark.parametrize(
    ("code", "said", "place"),
    [
        ("de", "Fahr bitte zur Apotheke", "pharmacy"),
        ("de", "geh zu der arzneiausgabe", "pharmacy"),
        ("de", "Fahr ins Kino", "cinema"),
        ("de", "fahr zu movies", "cinema"),
        ("de", "fahr zu pharmacy", "pharmacy"),
        ("de", "fahr in die Kombüse", "kitchen"),
        ("de", "fahr in die Küche", "kitchen"),
        ("fr", "va à la pharmacie", "pharmacy"),
        ("es", "ve a la farmacia", "pharmacy"),
        ("it", "vai all'apoteca", "pharmacy"),
        ("ru", "езжай в аптеку", "pharmacy"),
        ("ja", "薬局に行って", "pharmacy"),
        ("en", "go to the chemist", "pharmacy"),
    ],
)
def test_a_name_of_the_language_is_understood_and_means_the_same_place(code, said, place):
    found = Recogniser(WARD.skills, code).recognise(said)

    assert found == Understood((Call("navigate_to", {"location": place}),))


def test_a_name_of_a_language_is_no_word_of_another():
    found = Recogniser(WARD.skills, "fr").recognise("va à la arzneiausgabe")

    assert not isinstance(found, Understood)


def test_a_name_is_found_in_free_words_too():
    judged = Readings(WARD.skills, "de").of("ich brauche dich mal eben in der Apotheke drüben")

    assert judged is not None
    assert judged.reading.calls == (Call("navigate_to", {"location": "pharmacy"}),)


@pytest.mark.parametrize(
    ("code", "place", "going", "there"),
    [
        ("de", "pharmacy", "zur Apotheke", "bei der Apotheke"),
        ("de", "cinema", "zum Ort Kino", "am Ort Kino"),
        ("de", "kitchen", "zur Kombüse", "bei der Kombüse"),
        ("fr", "pharmacy", "dans la pharmacie", "à la pharmacie"),
        ("fr", "cinema", "au cinéma", "au cinéma"),
        ("es", "pharmacy", "al lugar farmacia", "en el lugar farmacia"),
        ("it", "pharmacy", "all'apoteca", "all'apoteca"),
        ("ru", "pharmacy", "в аптеку", "в аптеке"),
        ("ja", "pharmacy", "薬局へ", "薬局に"),
        ("en", "pharmacy", "to the chemist", "chemist"),
        ("tr", "pharmacy", "pharmacy", "pharmacy"),
    ],
)
def test_a_name_of_the_language_is_what_is_said(code, place, going, there):
    book = phrasebook_of(code, WARD.skills.values())

    assert going in book.acknowledge(GO, {"location": place})
    pose = {"location": place, "x": 1.0, "y": 2.0, "yaw_deg": 0.0}
    assert there in book.report(GO, {"location": place}, pose)
    assert there in book.report(WARD.skills["get_pose"], {}, pose)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_names_of_one_language_leave_all_others_as_they_are(code):
    book = phrasebook_of(code, WARD.skills.values())

    known = {"de": "Kombüse"}.get(code, str(phrasebook_of(code, ()).word("kitchen")))
    assert known in str(book.word("kitchen"))


def test_who_speaks_another_language_from_now_on_is_understood_in_it():
    german = phrasebook_of("de", WARD.skills.values())
    with Talk(skills=WARD.skills) as talk:
        assert "'arzneiausgabe'" in talk.say("go to the arzneiausgabe")
        talk.conversation.set_language("de")
        going = german.acknowledge(GO, {"location": "pharmacy"})
        assert talk.say("Fahr zur Arzneiausgabe") == going
        assert "„Bahnhof“" in talk.say("Fahr zum Bahnhof")
        assert "die Apotheke, Kino" in talk.say("Fahr zum Bahnhof")


def test_a_place_that_is_remembered_takes_no_name_of_the_file():
    for name in ("Apotheke", "arzneiausgabe", "pharmacie", "аптеку", "movies"):
        with pytest.raises(Exception, match="pharmacy|cinema"):
            WARD.memory.check(name)
    WARD.memory.check("Bahnhof")


@pytest.mark.parametrize(
    ("names", "field", "expected"),
    [
        ("{xx: Kino}", "names.xx", "a language: en, es"),
        ("{de: ''}", "names.de", "a name of at most 40"),
        ("{de: []}", "names.de", "at least one name"),
        ("{de: [Kino, halt mal]}", "names.de.1", "stops the robot in English"),
        ("{de: die Ja}", "names.de", "people say 'Ja' to a robot in German"),
        ("{de: oui}", "names.de", "people say 'oui' to a robot in French"),
        ("{de: hier}", "names.de", "stands for something else"),
        ("[de]", "names", "the code of a language to names"),
        ("{de: 3}", "names.de", "a name of at most 40"),
        ("{de: {heard: [Kino]}}", "names.de.name", "a name of at most 40"),
        ("{de: {name: Kino, heard: Film}}", "names.de.heard", "a list of names"),
        ("{de: {name: Kino, too: ins Kino}}", "names.de.too", "one of name, heard, to, at, taken"),
        ("{de: {name: Kino, to: 3}}", "names.de.to", "a text of at most 80"),
    ],
)
def test_a_wrong_name_is_refused_by_file_line_and_field(names, field, expected):
    with pytest.raises(InvalidValue) as caught:
        parse_locations(f"dock: {{x: 1, y: 2}}\nhall:\n  x: 1\n  y: 2\n  names: {names}", "a.yaml")

    assert caught.value.field == f"a.yaml:5: hall.{field}"
    assert expected in caught.value.expected


@pytest.mark.parametrize("other", ["Bühne", "das Kino", "kino", "[Saal, KINO]", "hall", "lobby"])
def test_two_places_are_never_called_the_same_in_one_language(other):
    text = (
        "hall: {x: 1, y: 2, aliases: [lobby], names: {de: [Kino, Theater], fr: Bühne}}\n"
        f"stage: {{x: 3, y: 4, names: {{de: {other}}}}}"
    )
    if other == "Bühne":
        assert parse_locations(text, "a.yaml")
        return
    with pytest.raises(InvalidValue) as caught:
        parse_locations(text, "a.yaml")
    assert caught.value.field == "a.yaml:2: stage.names.de"
    assert caught.value.expected == "a name that 'hall' does not have"


def test_the_rooms_of_a_world_have_names_by_language_too():
    world = parse_world(
        f"{ROBOT}custom: {{edgevox: {{rooms: {{ward: {{{ROOM}, names: {{de: die Station}}}}}}}}}}",
        "home.yaml",
    )

    assert world.rooms[0].names == {"de": OwnName("die Station")}
    with pytest.raises(InvalidValue, match=r"home.yaml:2: .*rooms.ward.names.de: .*'halt'"):
        parse_world(
            f"{ROBOT}custom: {{edgevox: {{rooms: {{ward: {{{ROOM}, names: {{de: halt}}}}}}}}}}",
            "home.yaml",
        )


def brush() -> Skill:
    modes = OneOf(
        ("soft", "hard"),
        {"gentle": "soft"},
        names={
            "soft": {"de": OwnName("sanft", ("weich",)), "en": OwnName("mild")},
            "hard": {"de": OwnName("gründlich")},
        },
    )

    german = SkillPhrases(templates=("bürste {mode}",), says=("Ich bürste {mode}.",))

    @skill(templates=["brush {mode}"], says="Brushing, {mode}.", phrases={"de": german})
    def brush(goal, mode: Annotated[str, modes]):
        """Brush the floor."""

    return brush


def test_the_values_of_a_skill_have_names_by_language_and_the_wire_keeps_the_words():
    with Talk(skills=SkillSet([brush()]), language="de") as talk:
        assert talk.say("bürste weich") == "Ich bürste sanft."
        assert "sanft und gründlich" in talk.say("bürste orange")
        talk.conversation.set_language("en")
        assert talk.say("brush mild") == "Brushing, mild."
        assert [dict(one.arguments) for one in talk.of(ToolCalled)] == [{"mode": "soft"}] * 2


THINGS = (
    "world: {width: 6, height: 6}\n"
    f"{ROBOT}obstacle:\n"
    "  - {shape: {name: rectangle, length: 1, width: 1}, state: [4, 4, 0], name: sofa, NAMES}\n"
)


def told_of_the_sofa(code: str, names: str, goal: tuple[float, float]) -> str:
    world = parse_world(THINGS.replace("NAMES", names), "home.yaml")
    with pytest.raises(SkillFailed) as caught:
        PathPlanner(world).plan((1.0, 1.0), goal, ())
    return phrasebook_of(code, ()).failure(caught.value.reason)


@pytest.mark.parametrize(
    ("code", "names", "said"),
    [
        ("en", "names: {de: das Sofa}", "there is a sofa."),
        ("en", "names: {en: the couch}", "there is the couch."),
        ("de", "names: {de: das Sofa}", "ist schon etwas (das Sofa)."),
        ("de", "names: {fr: le canapé}", "ist schon etwas."),
        ("fr", "names: {fr: le canapé}", "à cet endroit (le canapé)."),
        ("ja", "names: {ja: ソファ}", "何かがあります (ソファ)"),
    ],
)
def test_a_thing_of_a_world_is_mentioned_by_its_name_in_the_language(code, names, said):
    assert said in told_of_the_sofa(code, names, (4.0, 4.0))


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_name_of_a_thing_is_said_once_in_every_language(code):
    for goal in ((4.0, 4.0), (3.4, 4.0)):
        told = told_of_the_sofa(code, f"names: {{{code}: Zebra}}", goal)
        assert told.count("Zebra") == 1
        assert "sofa" not in told


@pytest.mark.parametrize(
    ("names", "field", "expected"),
    [
        ("names: {xx: Sofa}", "obstacle.0.names.xx", "a language: en, es"),
        ("names: {de: halt}", "obstacle.0.names.de", "which stops the robot"),
        ("names: {de: [Sofa, Couch]}", "obstacle.0.names.de", "one name: a thing is mentioned"),
        ("names: {de: {name: Sofa, to: zum Sofa}}", "obstacle.0.names.de", "one name"),
        ("nmaes: {de: Sofa}", "obstacle.0.nmaes", "did you mean 'names'?"),
    ],
)
def test_a_wrong_name_of_a_thing_is_told_by_file_line_and_field(names, field, expected):
    with pytest.raises(InvalidValue) as caught:
        parse_world(THINGS.replace("NAMES", names), "home.yaml")
    assert caught.value.field == f"home.yaml:4: {field}"
    assert expected in caught.value.expected


def test_the_robot_that_is_driven_has_no_names():
    with pytest.raises(InvalidValue, match=r"robot\.names.*no sentence mentions the robot"):
        parse_world(ROBOT.replace("state:", "names: {de: Kurt}, state:"), "home.yaml")


def test_what_is_in_nobodys_way_has_no_names():
    carpet = THINGS.replace("NAMES", "names: {de: der Teppich}, unobstructed: true")
    with pytest.raises(InvalidValue, match=r"home.yaml:4: obstacle.0.names: .* in nobody's way"):
        parse_world(carpet, "home.yaml")
