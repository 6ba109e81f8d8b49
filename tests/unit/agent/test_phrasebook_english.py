"""What is said of topics, of Nav2 and of what a robot can do, in every language."""

import pytest
from support.bodies import BODIES

from edgevox.agent.agents import Agent
from edgevox.agent.dialogue.skills import CAN, DialogueSkills
from edgevox.agent.nlu.abilities import abilities, not_understood
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import detail
from edgevox.agent.text.reasons import because
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES

TOPICS = ("robot_silent", "robot_unheard", "lost", "incredible", "goals_unheard", "stop_unseen")


ASKED = DialogueSkills(
    [Agent("apartment", "", BODIES["apartment"])],
    Bus(),
    SystemClock(),
    lambda: phrasebook(ENGLISH),
).agents[0]


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_topic_is_written_and_read_by_programs_but_not_said(language):
    book = phrasebook(language)
    for code in TOPICS:
        why = because(code, topic="/robot1/odom")

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


def test_the_abilities_that_are_not_said_are_written_and_none_twice():
    skills = list(BODIES["apartment"].values())
    said, written = abilities(phrasebook("en"), skills)
    assert said.endswith(f"and {len(written.split('; '))} more things.")
    assert not [one for one in written.removesuffix(".").split("; ") if one.lower() in said]
