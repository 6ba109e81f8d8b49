"""Sums with two numbers are worked out, in sixteen languages, and nothing else is taken for one."""

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
    "over": lambda a, b: a / b,
    "percent": lambda a, b: a * b / 100,
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
    exact = round(value, 2) == pytest.approx(value, rel=1e-9)
    told = phrasebook(code).say("sum" if exact else "sum_about", result=f"{round(value, 2):.15g}")

    assert answer_to_sum(wording.format(a=a, b=b), code) == told


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
        "what is seven times a lot",
        "",
    ],
)
def test_nothing_else_is_a_sum(says: str) -> None:
    assert answer_to_sum(says, "en") == ""
