import random
from functools import cache

import pytest
from few_languages import few
from support.bodies import BODIES, FACTS, say_it

from edgevox.agent.agents import Agent
from edgevox.agent.dialogue.skills import (
    ALSO,
    DIALOGUE_SKILLS,
    OF_DIALOGUE,
    DialogueSkills,
)
from edgevox.agent.known import Known
from edgevox.agent.nlu.meaning import REFERENCES
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.stop.words import SafetyWords
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.languages import LANGUAGES

AGENTS = {
    body: DialogueSkills(
        [Agent(body, "", skills)],
        Bus(),
        SystemClock(),
        lambda: phrasebook(ENGLISH),
        Known(facts=FACTS[body]),
    ).agents[0]
    for body, skills in BODIES.items()
}
SAMPLES = 4
OF_THE_BODY = {"go_back": "walk_backward", "further": "walk_forward"}
"""What a body that walks understands of itself where another one refers to its last drive."""


@cache
def sentences(code, body):
    """Each question and reference with sentences of every template, each once."""
    return tuple(dict.fromkeys(_sentences(code, body)))


def _sentences(code, body):
    book, source = phrasebook(code), random.Random(7)
    for name, one in AGENTS[body].dialogue_skills.items():
        templates = book.templates(one)
        assert templates, (code, name)
        for template in templates * SAMPLES:
            yield name, say_it(book, one, template, source)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("code", few(LANGUAGES))
def test_what_is_asked_about_the_conversation_is_understood_in_every_language(code, body):
    agent = AGENTS[body]
    recogniser = Recogniser(agent.skills, code, agent.dialogue_skills)

    for name, sentence in sentences(code, body):
        found = recogniser.recognise(sentence)
        assert isinstance(found, Understood), (name, sentence)
        (call,) = found.calls
        own = call.skill in agent.skills and name in (*REFERENCES, ALSO)
        tells = name not in DIALOGUE_SKILLS and not agent.every_skill[call.skill].moves
        assert call.skill == name or own or tells, (name, sentence, call)


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_such_sentence_holds_a_stop_word_so_that_none_can_hide_one(code):
    safety = SafetyWords(code)
    for name, sentence in dict.fromkeys(one for body in BODIES for one in sentences(code, body)):
        assert safety.find(sentence) is None, (name, sentence)


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_stop_word_beside_such_a_sentence_still_stops(code):
    word = LANGUAGES[code].stop.anywhere[0]
    safety = SafetyWords(code)
    for _, sentence in sentences(code, "apartment"):
        assert safety.find(f"{word.capitalize()}! {sentence}"), sentence
        assert safety.find(f"{sentence}. {word.capitalize()}!"), sentence


@pytest.mark.parametrize("code", few(LANGUAGES))
@pytest.mark.parametrize("body", BODIES)
def test_what_a_body_understands_by_itself_it_understands_beside_these_too(code, body):
    agent, book, source = AGENTS[body], phrasebook(code), random.Random(8)
    alone, beside = (
        Recogniser(agent.skills, code),
        Recogniser(agent.skills, code, agent.dialogue_skills),
    )

    for one in agent.skills.values():
        for template in book.templates(one):
            sentence = say_it(book, one, template, source)
            assert beside.recognise(sentence) == alone.recognise(sentence), sentence


@pytest.mark.parametrize("code", [code for code in LANGUAGES if code != ENGLISH])
def test_a_phrasebook_has_them_all_and_a_name_for_each_argument(code):
    book, english = phrasebook(code), phrasebook(ENGLISH)

    facts = {one.name for facts in FACTS.values() for one in facts}
    of_bodies = facts - {"battery", "take_picture"}
    assert set(english.dialogue) == {*DIALOGUE_SKILLS, *OF_DIALOGUE, *of_bodies}
    assert set(book.dialogue) == set(english.dialogue)
    assert set(book.arguments) == set(english.arguments) - {"location", "word"}
