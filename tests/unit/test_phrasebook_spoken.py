import pytest
from support.bodies import BODIES, SKILLS

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed, SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded
from edgevox.core.languages import LANGUAGES
from edgevox.core.reason import Reason

OTHERS = [code for code in LANGUAGES if code != ENGLISH]
RESULTS = {
    "room": "living room",
    "location": "living room",
    "x": 2.0,
    "y": -0.25,
    "z": 0.3,
    "yaw_deg": 90.0,
    "percent": 87,
    "walked": 1.02,
    "turned": 89.6,
    "got_up": True,
    "fallen": False,
    "held": "red_cube",
    "released": "blue_cube",
    "name": "wine_cellar",
    "names": ["kitchen", "office"],
    "objects": {"red_cube": {"x": 0.5, "on": "table"}, "blue_cube": {"x": 0.5, "on": "hand"}},
}
ARGUMENTS = {"room": "kitchen", "x": 1.5, "y": 2.0, "z": 0.25, "distance": 0.5, "degrees": 90.0}
ARGUMENTS |= {"object": "red_cube", "target": "left_bin", "name": "wine_cellar"}


@pytest.mark.parametrize("code", OTHERS)
@pytest.mark.parametrize("name", SKILLS)
def test_what_is_said_of_a_skill_is_whole_and_not_english(code, name):
    one, book, english = SKILLS[name], phrasebook(code), phrasebook(ENGLISH)
    arguments = {a: ARGUMENTS[a] for a in one.arguments_model.model_fields}
    for said, usual in (
        (book.acknowledge(one, arguments), english.acknowledge(one, arguments)),
        (book.report(one, arguments, RESULTS), english.report(one, arguments, RESULTS)),
    ):
        assert bool(said) == bool(usual)
        assert not said or said != usual
        assert not set("{}_<>") & set(said)
        assert "None" not in said
        assert "the " not in said


@pytest.mark.parametrize("code", OTHERS)
@pytest.mark.parametrize("name", [name for name, one in SKILLS.items() if one.drives])
def test_whether_to_do_something_is_asked_whole_and_not_in_english(code, name):
    one = SKILLS[name]
    arguments = {a: ARGUMENTS[a] for a in one.arguments_model.model_fields}
    asked = phrasebook(code).question([(one, arguments)])
    both = phrasebook(code).question([(one, arguments), (one, arguments)])

    for text in (asked, both):
        assert text.rstrip()[-1] in "?？؟"
        assert not set("{}_<>") & set(text)
        assert "None" not in text
        assert "hall I" not in text
    assert len(both) > len(asked)


@pytest.mark.parametrize(
    ("code", "asked"),
    [
        ("en", "Shall I go to the living room?"),
        ("de", "Soll ich ins Wohnzimmer fahren?"),
        ("fr", "Dois-je aller au salon ?"),
        ("ru", "Мне поехать в гостиную?"),
        ("tr", "Şimdi oturma odasına gideyim mi?"),
        ("zh", "要我去客厅吗？"),
        ("ja", "リビングへ行ってもいいですか?"),
    ],
)
def test_a_question_is_made_of_the_skills_own_words(code, asked):
    one = BODIES["apartment"]["navigate_to"]

    assert phrasebook(code).question([(one, {"room": "living_room"})]) == asked


@pytest.mark.parametrize(
    ("code", "asked"),
    [("en", "Shall I do this? Dancing."), ("de", "Soll ich das tun? Dancing.")],
)
def test_a_strangers_skill_is_asked_about_in_what_it_says(code, asked):
    @skill(says="Dancing.")
    def dance(goal):
        """Dance."""

    assert phrasebook(code).question([(dance, {})]) == asked


@pytest.mark.parametrize(
    ("code", "says", "done"),
    [
        ("fr", "Je vais au salon.", "Je suis dans le salon."),
        ("es", "Voy al salón.", "Estoy en el salón."),
        ("it", "Vado in soggiorno.", "Sono in soggiorno."),
        ("pt", "Vou para a sala.", "Estou na sala."),
        ("de", "Ich fahre ins Wohnzimmer.", "Ich bin im Wohnzimmer."),
    ],
)
def test_rooms_are_spoken_of_with_the_right_little_words(code, says, done):
    one, book = BODIES["apartment"]["navigate_to"], phrasebook(code)

    assert book.acknowledge(one, {"room": "living_room"}) == says
    assert book.report(one, {"room": "living_room"}, {"room": "living room"}) == done


def test_a_room_that_no_phrasebook_knows_is_said_by_its_own_name():
    one = BODIES["apartment"]["navigate_to"]

    assert phrasebook("fr").acknowledge(one, {"room": "wine_cellar"}) == "Je vais vers wine cellar."


@pytest.mark.parametrize(
    ("room", "said"),
    [
        ("kitchen", "Je suis dans la cuisine, à x 2, y -0,2."),
        (None, "Je suis à x 2, y -0,2."),
    ],
)
def test_the_first_sentence_whose_values_are_known_is_said(room, said):
    result = {"x": 2.0, "y": -0.25, "room": room}

    assert phrasebook("fr").report(BODIES["apartment"]["get_pose"], {}, result) == said


@pytest.mark.parametrize(
    ("distance", "said"), [(0.5, "0,5 mètre"), (1.0, "1 mètre"), (2.5, "2,5 mètres")]
)
def test_numbers_are_written_and_counted_as_the_language_does(distance, said):
    text = phrasebook("fr").acknowledge(BODIES["humanoid"]["walk_forward"], {"distance": distance})

    assert text == f"J'avance de {said}."


def test_a_skill_without_phrases_speaks_english():
    @skill(says="Dancing for {seconds:g} seconds.")
    def dance(goal, seconds: float):
        """Dance."""

    assert phrasebook("fr").acknowledge(dance, {"seconds": 3.0}) == "Dancing for 3 seconds."


@pytest.mark.parametrize(
    ("reason", "french"),
    [
        (because("no_way"), "aucun chemin n'y mène"),
        (
            because("outside", place="flat", x_min="0", x_max="9.5", y_min="0", y_max="10"),
            "ce point est en dehors de la carte : x doit être entre 0 et 9,5, et y entre 0 et 10",
        ),
        (
            because("hand_full", thing="red cube"),
            "je tiens le cube rouge, il faut d'abord le poser",
        ),
        (Reason("The moon is in the way."), "The moon is in the way"),
    ],
)
def test_a_reason_is_said_in_the_language_if_it_is_a_known_one(reason, french):
    assert phrasebook("fr").failure(reason) == f"Je n'ai pas pu le faire : {french}."


def test_a_conversation_is_understood_and_answered_in_the_language_it_is_set_to():
    bus, said = Bus(), []
    bus.subscribe(Responded, lambda event: said.append(event.text))

    @skill(templates=["where are you"], done="I am {where}.", moves=False)
    def get_pose(goal):
        """Say where the robot is."""
        return {"x": 1.0, "y": 2.0, "where": "at x 1.0, y 2.0"}

    @skill(templates=["battery"], done="{percent}", moves=False)
    def battery(goal):
        """Say how full the battery is."""
        raise SkillFailed(because("switched_off"))

    agent = Agent("robot", "", SkillSet([get_pose, battery]))
    talk = Conversation([agent], bus, halt=lambda reason: False, language="fr")
    talk.start()
    for code, text in (
        ("fr", "Où es-tu ?"),
        ("fr", "Quel est ton niveau de batterie ?"),
        ("fr", "abracadabra"),
        ("it", "Dove sei?"),
        ("it", "where are you"),
    ):
        talk.set_language(code)
        talk.submit(TextInput(text))
        assert talk.wait_idle(10.0)
    talk.close()

    assert said == [
        "Je suis à x 1, y 2.",
        "Je n'ai pas pu le faire : je suis éteint.",
        "Je n'ai pas compris, mais je sais par exemple dire où je suis.",
        "Sono a x 1, y 2.",
        "Sono a x 1, y 2.",
    ]
