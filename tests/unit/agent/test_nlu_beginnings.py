"""A template is tried for every sentence that it stands for, and for few others."""

import random

import pytest
from hassil.parse_expression import parse_sentence
from support.bodies import SKILLS, say_it

from edgevox.agent.nlu.templates import ANY, beginnings, compile_templates, said
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillSet, skill
from edgevox.agent.text.spelling import folded, separated
from edgevox.core.files.text import one_form
from edgevox.core.languages import LANGUAGES

RULES = {"go": parse_sentence("(go|drive)"), "now": parse_sentence("[now|at once]")}


@skill(templates=["[please] (sing|hum) a song", "{tune} please", "Über alles"])
def sing(goal, tune: str = ""):
    """Sing."""


def tried(text):
    """The templates that are compared with this sentence, by how they are written."""
    templates = compile_templates(SkillSet([sing]), phrasebook("en"), loose=False)
    found = templates.fitting(text).intents.values()
    return [one.text for intent in found for block in intent.data for one in block.sentences]


@pytest.mark.parametrize(
    ("template", "begins"),
    [
        ("go home", {"go"}),
        ("(Go|drive on) home", {"go", "drive"}),
        ("[please|could you] go", {"please", "could", "go"}),
        ("[please] [now] (go|stop)", {"please", "now", "go", "stop"}),
        ("<now> <go> home", {"now", "at", "go", "drive"}),
        ("go[ing] home", {"go"}),
        ("{room} please", {ANY}),
        ("[to] {room}", {ANY}),
        ("[please]", {ANY}),
        ("(go;now)", {ANY}),
        ("'t is late", {ANY}),
        ("去厨房", {"去厨房"}),
    ],
)
def test_a_sentence_begins_with_what_its_template_may_begin_with(template, begins):
    assert beginnings(parse_sentence(template), RULES) == begins


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_sentence_of_any_template_begins_otherwise(code):
    book, source = phrasebook(code), random.Random(3)
    rules = {name: parse_sentence(_written(rule)) for name, rule in book.rules.items()}
    for one in SKILLS.values():
        for template in book.templates(one):
            begins = tuple(beginnings(parse_sentence(_written(template)), rules))
            sentence = said(_written(say_it(book, one, template, source)))
            assert sentence.startswith(begins), (template, sentence)


@pytest.mark.parametrize("text", ["sing a song", "  Sing a song", "...sing a song!", "SING"])
def test_a_template_is_tried_where_a_sentence_begins_as_it_does(text):
    assert tried(text) == ["[please] (sing|hum) a song", "{tune} please"]


@pytest.mark.parametrize("text", ["where are you", "", "?", "- sing", "5 songs", "ſong"])
def test_where_none_begins_so_only_what_may_begin_with_any_word_is_tried(text):
    assert tried(text) == ["{tune} please"]


def test_a_letter_counts_with_and_without_its_accent_and_capital():
    assert tried("uber alles") == tried("UBER alles") == ["{tune} please", "Uber alles"]


def _written(text):
    return folded(separated(one_form(text)))
