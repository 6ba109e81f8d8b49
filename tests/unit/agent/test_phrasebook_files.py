import ast
import random
from pathlib import Path

import pytest
from code_files import trees
from few_languages import few
from support.bodies import BODIES, SKILLS, say_it

import edgevox
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import STOP
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import fields
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES, language_file

OTHERS = [code for code in LANGUAGES if code != ENGLISH]
DEEP = ("fr", "es", "it", "pt", "de")
"""The languages with examples of every skill of the apartment; others may leave some to English."""
SAMPLES = 3


@pytest.mark.parametrize("code", OTHERS)
def test_a_phrasebook_says_every_sentence_that_english_says_with_the_same_values(code):
    english, book = phrasebook(ENGLISH).sentences, phrasebook(code).sentences

    assert book.keys() == english.keys()
    for name, sentence in english.items():
        mine = {value.split("!")[0] for value in fields(book[name])}
        assert mine <= fields(sentence), name
        assert fields(sentence) - mine <= {"argument"}, name


@pytest.mark.parametrize("code", OTHERS)
def test_a_phrasebook_knows_every_skill_of_every_body(code):
    book, english = phrasebook(code), phrasebook(ENGLISH)
    assert book.skills.keys() == {one.name for one in SKILLS.values()}
    for one in SKILLS.values():
        phrases, usual = book.skills[one.name], english.skills[one.name]
        assert phrases.can, one.name
        assert book.templates(one), one.name
        assert bool(phrases.says) == bool(usual.says), one.name
        assert bool(phrases.done) == bool(usual.done), one.name
        asked_about = one.drives or one.lasting
        assert bool(phrases.actions) == asked_about == bool(usual.actions), one.name


def test_english_has_what_each_skill_of_each_body_says():
    english = phrasebook(ENGLISH)
    entries = {one.entry or one.name for one in SKILLS.values()}
    assert english.skills.keys() == entries
    for one in SKILLS.values():
        phrases = english.skills[one.entry or one.name]
        assert phrases.can, one.name
        assert bool(phrases.says) == one.moves, one.name
        assert bool(phrases.done) == (one.name != STOP), one.name


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_template_suits_a_skill_of_its_entry(code):
    book = phrasebook(code)
    for name, phrases in book.skills.items():
        asked = [one for one in SKILLS.values() if name in {one.entry, one.name}]
        suited = {template for one in asked for template in book.templates(one)}
        assert suited >= set(phrases.templates), name


def test_bodies_are_asked_in_different_ways_for_what_they_answer_in_the_same():
    english, german = phrasebook(ENGLISH), phrasebook("de")
    arm, wheels = SKILLS["panda.get_pose"], SKILLS["apartment.get_pose"]

    assert not set(english.templates(arm)) & set(english.templates(wheels))
    assert english.can(arm) == english.can(wheels)
    assert german.templates(arm) == german.templates(wheels)


def test_no_skill_of_ours_names_a_sentence():
    for name, one in SKILLS.items():
        brought = (*one.templates, *one.examples, one.says, one.done, one.action)
        assert not any(brought), name


@pytest.mark.parametrize("code", OTHERS)
def test_every_word_that_a_body_knows_can_be_said_and_means_one_thing(code):
    book = phrasebook(code)
    for name, one in SKILLS.items():
        for choices in one.choices.values():
            assert {key(word) for word in choices.words} <= book.words.keys(), name
            said = [key(said) for word in choices.words for said in book.word(word).heard]
            assert len(said) == len(set(said)), (name, sorted(said))


@pytest.mark.parametrize("code", few(OTHERS))
def test_what_a_template_stands_for_is_understood_and_stops_nobody(code):
    book, safety, source = phrasebook(code), SafetyWords(code), random.Random(4)
    for body, skills in BODIES.items():
        recogniser = Recogniser(skills, code)
        for name, one in skills.items():
            templates = book.templates(one) * SAMPLES
            for sentence in dict.fromkeys(say_it(book, one, each, source) for each in templates):
                if name == "stop" and safety.find(sentence):
                    continue
                assert safety.find(sentence) is None, sentence
                found = recogniser.recognise(sentence)
                assert isinstance(found, Understood), (body, name, sentence)
                assert [call.skill for call in found.calls] == [name], (body, sentence)
                assert not found.unsure, (body, sentence)


@pytest.mark.parametrize("code", ["en", *few(OTHERS)])
def test_what_the_robot_must_ask_about_is_understood_and_asked_about(code):
    book, safety, source = phrasebook(code), SafetyWords(code), random.Random(4)
    for body, skills in BODIES.items():
        recogniser = Recogniser(skills, code)
        for name, one in skills.items():
            templates = book.asking(one) * SAMPLES
            for sentence in dict.fromkeys(say_it(book, one, each, source) for each in templates):
                assert safety.find(sentence) is None, sentence
                found = recogniser.recognise(sentence)
                assert isinstance(found, Understood), (body, name, sentence)
                if found.unsure:  # else another skill's own sentence counts first
                    assert [call.skill for call in found.calls] == [name], (body, sentence)


def test_no_template_catches_an_example_and_every_example_is_a_valid_call():
    recogniser = Recogniser(BODIES["panda"])
    for one in BODIES["panda"].values():
        examples = phrasebook(ENGLISH).examples(one)
        assert examples or one.plainly
        for example in examples:
            assert recogniser.recognise(example.sentence) is None, example.sentence
            one.validate(example.arguments)


@pytest.mark.parametrize("code", OTHERS)
def test_a_phrasebook_gives_every_reason_that_english_gives_with_no_other_values(code):
    english, book = phrasebook(ENGLISH).reasons, phrasebook(code).reasons

    assert book.keys() == english.keys()
    for name, reason in book.items():
        assert fields(reason) <= fields(english[name]), name


def test_every_reason_has_a_code_that_somebody_gives_and_every_code_a_reason():
    assert _codes_given() == phrasebook(ENGLISH).reasons.keys()


@pytest.mark.parametrize("code", OTHERS)
def test_the_examples_of_a_language_are_its_own_and_valid(code):
    book, english = phrasebook(code), phrasebook(ENGLISH)
    assert [bool(one.answer) for one in book.everyday] == [False, True, False, True]
    assert not {one.asked for one in book.everyday} & {one.asked for one in english.everyday}
    for one in SKILLS.values():
        for example in book.examples(one):
            one.validate(example.arguments)
    assert code not in DEEP or all(
        book.examples(one) != english.examples(one)
        for one in BODIES["apartment"].values()
        if english.examples(one)
    )


def test_a_language_that_nobody_knows_is_refused_by_name():
    with pytest.raises(InvalidValue, match="klingon"):
        phrasebook("klingon")


def _codes_given():
    """The codes that the code names when it says why something was not done."""
    calls = [
        node
        for _, tree in trees(Path(edgevox.__file__).parent, having=r"\bbecause\b")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "because"
    ]
    return {ast.literal_eval(call.args[0]) for call in calls}


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_answer_which_languages_it_speaks_names_all(code):
    table = language_file(code)
    names = table["rules"]["language"].strip("()").split("|")

    assert len(names) == len(LANGUAGES)
    assert all(one in table["facts"]["which_languages"]["done"] for one in names)
