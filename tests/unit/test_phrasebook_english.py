"""What robots say in English, word for word, from where all other languages stand."""

import pytest
from support.bodies import BODIES

from edgevox.agent.abilities import abilities, not_understood
from edgevox.agent.agents import Agent
from edgevox.agent.dialogue_skills import CAN, DialogueSkills
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillSet
from edgevox.agent.spoken_lists import detail
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES
from edgevox.robots.navigation import LOCATION, navigation_skills

POINT = {"x": 1.0, "y": -0.25, "yaw_deg": 90.0}
HAND = {"x": 0.5, "y": 0.0, "z": 0.251, "held": None}
TOPICS = ("robot_silent", "robot_unheard", "lost", "incredible", "goals_unheard", "stop_unseen")


class Depot:
    """A body whose places are locations."""

    places = {"shelf_b": (1.0, 2.0)}  # noqa: RUF012 - nobody changes it


ASKED = DialogueSkills(
    [Agent("apartment", "", BODIES["apartment"])],
    Bus(),
    SystemClock(),
    lambda: phrasebook(ENGLISH),
).agents[0]
BODIES_HERE = {**BODIES, "depot": SkillSet(navigation_skills(Depot(), word=LOCATION))}


@pytest.mark.parametrize(
    ("body", "name", "arguments", "result", "said"),
    [
        ("apartment", "navigate_to", {"room": "living_room"}, {}, "I am in the living room."),
        ("depot", "navigate_to", {"location": "shelf_b"}, {}, "I am at the shelf b."),
        ("apartment", "navigate_xy", {}, POINT, "I am at x 1.0, y -0.2."),
        (
            "apartment",
            "get_pose",
            {},
            {**POINT, "room": "living room"},
            "I am in the living room, at x 1.0, y -0.2.",
        ),
        (
            "depot",
            "get_pose",
            {},
            {**POINT, "location": "shelf b"},
            "I am at the shelf b, at x 1.0, y -0.2.",
        ),
        ("depot", "get_pose", {}, {**POINT, "location": None}, "I am at x 1.0, y -0.2."),
        (
            "humanoid",
            "get_pose",
            {},
            {**POINT, "fallen": False, "upright": True},
            "I am at x 1.0, y -0.2, looking 90 degrees.",
        ),
        (
            "humanoid",
            "get_pose",
            {},
            {**POINT, "fallen": True, "upright": False},
            "I am on the floor at x 1.0, y -0.2, looking 90 degrees.",
        ),
        ("humanoid", "stand", {}, {"got_up": False}, "I am standing."),
        (
            "humanoid",
            "stand",
            {},
            {"got_up": True},
            "I am up again: the simulator put me on my feet.",
        ),
        ("panda", "get_pose", {}, HAND, "My hand is at x 0.50, y 0.00, z 0.25."),
        (
            "panda",
            "get_pose",
            {},
            {**HAND, "held": "red_cube"},
            "My hand is at x 0.50, y 0.00, z 0.25, and I hold the red cube.",
        ),
        (
            "panda",
            "place",
            {"object": "it", "target": "left_bin"},
            {**HAND, "object": "red_cube"},
            "The red cube is in the left bin.",
        ),
        (
            "panda",
            "place",
            {"object": "red_cube", "target": "table"},
            {**HAND, "object": "red_cube"},
            "The red cube is on the table.",
        ),
        ("panda", "release", {}, {"released": "red_cube"}, "I let go of the red cube."),
        ("panda", "release", {}, {"released": None}, "My hand is open."),
        (
            "panda",
            "list_objects",
            {},
            {
                "objects": {
                    "red_cube": {"on": "table"},
                    "green_cube": {"on": "right_bin"},
                    "blue_cube": {"on": "hand"},
                }
            },
            (
                "I see the red cube on the table, the green cube in the right bin "
                "and the blue cube in my hand."
            ),
        ),
        (
            "apartment",
            "list_places",
            {},
            {"names": ["kitchen", "living_room", "charger"]},
            "I know kitchen, living room and charger.",
        ),
        ("apartment", "list_places", {}, {"names": []}, "I know no place by name yet."),
        (
            "apartment",
            "forget_place",
            {"room": "charger"},
            {},
            "I have forgotten the place charger.",
        ),
    ],
)
def test_a_skill_says_in_english_what_it_always_said(body, name, arguments, result, said):
    assert phrasebook(ENGLISH).report(BODIES_HERE[body][name], arguments, result) == said


@pytest.mark.parametrize("code", TOPICS)
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_topic_is_written_and_read_by_programs_but_not_said(language, code):
    book, why = phrasebook(language), because(code, topic="/robot1/odom")

    assert "/robot1/odom" in why.text
    assert "/robot1/odom" not in book.failure(why)
    assert "/robot1/odom" in detail(book, why)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("body", BODIES)
def test_what_is_written_after_a_sentence_that_nobody_understood_is_short_and_says_how_to_ask(
    body, language
):
    book, skills = phrasebook(language), list(BODIES[body].values())
    said, written = not_understood(book, skills)
    question = book.say("abilities_question")

    assert book.can(skills[0]) in said
    assert question in written
    assert written.count(book.can(skills[1])) == 1
    assert sum(book.can(one) in written for one in skills) < len(skills)
    assert len(written) < len("".join(abilities(book, skills))) + len(question)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_question_for_all_that_a_robot_can_do_is_understood(language):
    found = Recogniser(ASKED.skills, language, ASKED.dialogue_skills).recognise(
        phrasebook(language).say("abilities_question")
    )

    assert isinstance(found, Understood)
    assert [call.skill for call in found.calls] == [CAN]


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("how", ["nav2_gave_up", "nav2_cancelled"])
def test_how_nav2_ended_is_said_in_the_words_of_the_language(language, how):
    book = phrasebook(language)
    said = book.failure(because("nav2_ended", how=because(how)))

    assert book.reasons[how] in said
    assert language == ENGLISH or phrasebook(ENGLISH).reasons[how] not in said
