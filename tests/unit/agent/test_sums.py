"""Sums with two numbers are worked out, in sixteen languages, and nothing else is taken for one."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.nlu.sums import answer_to_sum
from edgevox.agent.phrases.load import phrasebook
from edgevox.core.languages import LANGUAGES

SUMS = {
    "plus": lambda a, b: a + b,
    "minus": lambda a, b: a - b,
    "times": lambda a, b: a * b,
    "over": Fraction,
    "percent": lambda a, b: Fraction(a * b, 100),
}
WORDINGS = [
    (code, name, wording)
    for code in sorted(LANGUAGES)
    for name, several in phrasebook(code).sums.items()
    if name in SUMS
    for wording in several
]


@pytest.mark.parametrize("code", sorted(LANGUAGES))
def test_each_language_has_every_kind_of_sum(code: str) -> None:
    assert phrasebook(code).sums.keys() == {*SUMS, "behind"}


@given(st.sampled_from(WORDINGS), st.integers(2, 999), st.integers(2, 999))
def test_a_sum_is_right_in_every_wording(said: tuple[str, str, str], a: int, b: int) -> None:
    code, name, wording = said
    value = SUMS[name](a, b)
    told = "sum" if round(value, 2) == value else "sum_about"
    result = phrasebook(code).say(told, result=f"{float(round(value, 2)):.15g}")

    assert answer_to_sum(wording.format(a=a, b=b), code) == (
        result if round(value, 2) or not value else ""
    )


@pytest.mark.parametrize(
    ("code", "says", "answer"),
    [
        ("en", "What's seventeen times twelve?", "That is 204."),
        ("en", "what is fifteen percent of eighty", "That is 12."),
        ("en", "what is 10 divided by 3", "That is about 3.33."),
        ("de", "was ist siebzehn mal zwölf", "Das ist 204."),
        ("de", "was ist 3,5 plus 2", "Das ist 5,5."),
        ("fr", "combien font dix-sept fois douze", "Cela fait 204."),
        ("ru", "сколько будет семнадцать умножить на двенадцать", "Это 204."),
        ("zh", "17乘以12等于多少", "等于204。"),
        ("ja", "17かける12は", "204です。"),
        ("tr", "17 çarpı 12 kaç eder?", "Sonuç 204."),
        ("hi", "सत्रह गुणा बारह कितना होता है", "यह 204 है।"),
    ],
)
def test_a_question_with_a_sum_gets_its_result(code: str, says: str, answer: str) -> None:
    assert answer_to_sum(says, code) == answer


@pytest.mark.parametrize(
    "says",
    [
        "what is 5 divided by 0",
        "how much is 2 times 3 times 4",
        "is it 5 or 6 minutes",
        "three times",
        "it is 3 x 4 metres",
        "is it 24/7",
        "room 10-4",
        "what is minus 3 plus 5",
        "what is -3 plus 5",
        "what is 2 times 3 million",
        "what is 2 plus 3 times four",
        "what is 2 plus 3 squared",
        "what is the square root of 16 plus 9",
        "what is 50 plus 10 percent",
        "what is 1,000 plus 5",
        "bring me the 2 x 4",
        "is there a table of 3 x 4 metres?",
        "what is 1 divided by 1000",
        "what is seven times a lot",
        "",
    ],
)
def test_nothing_else_is_a_sum(says: str) -> None:
    assert answer_to_sum(says, "en") == ""


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("de", "was ist 1.000 plus 5"),
        ("es", "¿hay una mesa de 3 por 4 metros?"),
        ("ar", "الغرفة 3 في 4"),
        ("it", "prendi il 2 per 4"),
        ("fr", "combien font moins 3 plus 5"),
    ],
)
def test_nor_is_it_in_other_languages(code: str, says: str) -> None:
    assert answer_to_sum(says, code) == ""
