"""Yes and no in sixteen languages, in many words."""

from itertools import combinations

import pytest
from few_languages import few
from support.bodies import BODIES
from support.conversation import Talk

from edgevox.agent.dialogue.acts import Answer, Answers
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.tables import AnswerWords
from edgevox.agent.skills import STOP
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.text.spelling import key
from edgevox.core.languages import LANGUAGES

ENOUGH = 30
FIELDS = ("yes", "no", "not_", "polite")
COMMANDS = {"it": {"vai avanti"}, "pt": {"vai em frente", "vá em frente"}}
"""Answers that are a command to a robot that walks, and are one where it asked nothing."""


def answers_of(code):
    book = phrasebook(code)
    tables = (book.answers, phrasebook(ENGLISH).answers)
    return Answers(tables, spaced=book.hearing.spaced)


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_language_has_enough_words_for_both(code):
    words = phrasebook(code).answers
    assert min(len({*map(key, words.yes)}), len({*map(key, words.no)})) >= ENOUGH
    assert words.not_
    assert len(words.polite) >= 8
    assert len(words.little) >= 15


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_word_is_of_two_kinds_beside_english(code):
    books = (phrasebook(code), phrasebook(ENGLISH))
    keys = {f: {w.casefold() for book in books for w in getattr(book.answers, f)} for f in FIELDS}
    for one, other in combinations(FIELDS, 2):
        if {one, other} == {"no", "not_"}:
            continue  # "nunca" is an answer, and negates what follows it
        assert not keys[one] & keys[other], (one, other)


@pytest.mark.parametrize("code", LANGUAGES)
def test_urging_agrees_only_beside_a_yes(code):
    words, answers = phrasebook(code).answers, answers_of(code)
    for urging in words.urging:
        assert answers.read(f"{words.yes[0]}, {urging}") is Answer.YES
        assert answers.read(f"{words.no[0]}, {urging}") is None
        assert urging in words.yes or answers.read(urging) is None


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_answer_stops_the_robot_though_it_is_said_politely(code):
    words, safety = phrasebook(code).answers, SafetyWords(code)
    for said in (*words.yes, *words.no):
        for text in (said, *(f"{said}, {polite}" for polite in words.polite)):
            assert safety.find(text) is None, text


@pytest.mark.parametrize("code", LANGUAGES)
@pytest.mark.parametrize("answer", Answer)
def test_each_answer_is_read_as_what_it_is_however_it_is_written(code, answer):
    words, answers = phrasebook(code).answers, answers_of(code)
    for said in getattr(words, answer):
        for text in (said, said.upper(), f"{said}!", *_politely(said, words.polite)):
            assert answers.read(text) is answer, text


@pytest.mark.parametrize("code", few(LANGUAGES))
def test_an_answer_drives_no_robot_by_itself(code):
    words = phrasebook(code).answers
    for body in BODIES.values():
        recogniser = Recogniser(body, code)
        for said in {*words.yes, *words.no} - COMMANDS.get(code, set()):
            found = recogniser.recognise(said)
            assert not isinstance(found, Understood) or found.calls[0].skill == STOP, said


@pytest.mark.parametrize("code", few(LANGUAGES))
@pytest.mark.parametrize("answer", Answer)
def test_the_robot_goes_or_stays_at_each_of_them(code, answer):
    with Talk(confirm="always", language=code) as talk:
        for said in getattr(phrasebook(code).answers, answer):
            talk.body.sent.clear()
            talk.say("go to the kitchen")
            assert talk.statuses[-1] == "asked"
            talk.say(said)
            assert talk.body.sent == (["kitchen"] if answer is Answer.YES else []), said
            assert talk.statuses[-1] == ("confirmed" if answer is Answer.YES else "declined")


@pytest.mark.parametrize(
    "text",
    [
        "yes, but not the kitchen", "yes no", "is that a yes or a no", "please", "", "thank you",
        "yes " * 40, "no wonder", "yesterday", "know",
    ],
)  # fmt: skip
def test_what_only_begins_like_an_answer_is_none(text):
    assert answers_of("en").read(text) is None


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("zh", "是不是"),
        ("zh", "好不好"),
        ("pl", "no"),
        ("ja", "いいえはい"),
        ("de", "jagen"),
        ("vi", "đung"),
        ("vi", "Đừng!"),
        ("vi", "đừng vậy"),
    ],
)
def test_what_could_be_either_is_never_a_yes(code, text):
    assert answers_of(code).read(text) is not Answer.YES


def test_what_follows_a_no_is_read_without_it():
    answers = answers_of("en")
    assert answers.after_no("No, no! Go to the office.") == "Go to the office."
    assert answers_of("es").after_no("no vaya a la oficina") == ""
    assert answers.after_no("no") == answers.after_no("go on, then") == ""
    assert answers_of("ja").after_no("いいえ、書斎へ行って") == "書斎へ行って"


def test_without_words_there_are_no_answers():
    assert Answers([AnswerWords()]).read("yes") is None


def _politely(said, polite):
    return [text for one in polite for text in (f"{said} {one}", f"{one}, {said}.")]
