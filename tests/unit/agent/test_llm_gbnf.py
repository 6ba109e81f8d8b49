"""What a server sends is held against the grammar that it was asked to obey."""

import random
import time

import pytest
from gbnf_walk import Walker
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.llm.gbnf import Matcher
from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.protocol import grammar

OF_A_ROBOT = grammar(("driver", "host"))


def obeys(rules: str, text: str) -> bool:
    matcher = Matcher(rules)
    return matcher.accept(text) == len(text) and matcher.complete


@given(st.integers(0, 1 << 32))
def test_whatever_the_grammar_can_write_obeys_it(seed: int) -> None:
    assert obeys(OF_A_ROBOT, Walker(OF_A_ROBOT, random.Random(seed)).walk())


@given(st.integers(0, 1 << 32), st.data())
def test_where_a_text_is_cut_into_pieces_does_not_matter(seed: int, data: st.DataObject) -> None:
    text = Walker(OF_A_ROBOT, random.Random(seed)).walk()
    cut = data.draw(st.integers(0, len(text)))
    matcher = Matcher(OF_A_ROBOT)

    assert matcher.accept(text[:cut]) == cut
    assert matcher.accept(text[cut:]) == len(text) - cut
    assert matcher.complete


@pytest.mark.parametrize(
    "text",
    [
        "",
        "Sure! talk: Hello.",
        "talk: no end",
        "talk: a line\nand another.",
        "talk: One. Two. Three.",
        "colleague: ",
        "colleague: nobody",
        "colleague: driver!",
        "call: stop(); done",
        '{"tool": "stop"}',
    ],
)
def test_what_the_grammar_cannot_write_does_not_obey_it(text: str) -> None:
    assert not obeys(OF_A_ROBOT, text)


def test_the_first_wrong_character_is_told() -> None:
    assert Matcher(OF_A_ROBOT).accept("talk: fine.\n\nUser: and") == len("talk: fine.")


@pytest.mark.parametrize(
    ("rules", "good", "bad"),
    [
        ('root ::= "a"{2}', ["aa"], ["a", "aaa"]),
        ('root ::= "a"{2,}', ["aa", "aaaaa"], ["a"]),
        ('root ::= "a"+ "b"?', ["a", "aab"], ["b", "abb"]),
        ('root ::= ("a"*)* "b"', ["b", "aaab"], ["aa"]),
        ('root ::= "(" root ")" | ""', ["", "(())"], ["(()"]),
        ('root ::= one\none ::= "x" |\n  "y"', ["x", "y"], ["xy"]),
        (r'root ::= "\n\x41\u00e9\"\\"', ['\nAé"\\'], ["nAé"]),
        (r"root ::= [^\]\x00-\x1f]", ["[", "東"], ["]", "\n"]),
    ],
)
def test_what_gbnf_knows_is_known(rules: str, good: list[str], bad: list[str]) -> None:
    assert [text for text in good if not obeys(rules, text)] == []
    assert [text for text in bad if obeys(rules, text)] == []


@pytest.mark.parametrize(
    "rules",
    [
        'root ::= "go',
        "root ::= nothing",
        'other ::= "a"',
        'root ::= ("a"',
        'root ::= "a")',
        "root ::= *",
        "",
    ],
)
def test_a_grammar_that_does_not_parse_is_refused(rules: str) -> None:
    with pytest.raises(ModelFailed, match="grammar"):
        Matcher(rules)


def test_a_grammar_without_end_is_refused() -> None:
    with pytest.raises(ModelFailed, match="without end"):
        Matcher('root ::= root "a"')


def test_a_long_answer_is_followed_in_no_time() -> None:
    text = "talk: " + "x" * 150 + ". " + "y" * 150 + "."
    matcher, started = Matcher(OF_A_ROBOT), time.process_time()

    assert matcher.accept(text) == len(text)
    assert time.process_time() - started < 0.1
