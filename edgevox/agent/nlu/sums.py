"""Sums with two numbers, which a small language model often gets wrong: "what is 17 times 12"."""

import re
from collections.abc import Callable, Mapping
from functools import lru_cache

from edgevox.agent.nlu.questions import asks
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.text.spelling import NUMBER

_MOST = 1e12
_DECIMALS = 2
_EXACT = 1e-9
_A_NUMBER = re.compile(r"\d+(?:[.,]\d+)*")

_SUMS: Mapping[str, Callable[[float, float], float]] = {
    "plus": lambda a, b: a + b,
    "minus": lambda a, b: a - b,
    "times": lambda a, b: a * b,
    "over": lambda a, b: a / b,
    "percent": lambda a, b: a * b / 100,
}


def answer_to_sum(text: str, code: str) -> str:
    """The answer to the one sum in a text, in this language; empty for any other text.

    The text has no number beside the two of the sum, whose wordings are in `[sums]` of a language,
    and ends in it, or asks something.
    """
    plain = " ".join(text.split())
    for said in (plain, digits(plain, code)):
        for name, pattern, numbers in _patterns(code):
            found = pattern.search(said)
            if found is None or len(_A_NUMBER.findall(said)) != numbers:
                continue
            if asks(text, code) or _behind(code).fullmatch(said, found.end()):
                return _told(name, float(found["a"]), float(found["b"]), phrasebook(code))
    return ""


def _told(name: str, a: float, b: float, book: Phrasebook) -> str:
    if max(abs(a), abs(b)) > _MOST or (name == "over" and b == 0):
        return ""
    value = _SUMS[name](a, b)
    result = round(value, _DECIMALS)
    exact = abs(value - result) < _EXACT * max(1.0, abs(value))
    return book.say("sum" if exact else "sum_about", result=f"{result:.15g}")


@lru_cache
def _patterns(code: str) -> list[tuple[str, re.Pattern[str], int]]:
    """The wordings of a language's sums: kinds, patterns, and how many numbers are in each.

    A wording may hold a number word itself: "por ciento" is "por 100" in digits.
    """
    return [
        (name, _pattern(one), 2 + len(_A_NUMBER.findall(one)))
        for name, several in phrasebook(code).sums.items()
        if name in _SUMS
        for wording in several
        for one in dict.fromkeys((wording, digits(wording, code)))
    ]


@lru_cache
def _behind(code: str) -> re.Pattern[str]:
    """What may stand behind a sum: marks, and what asks for its result."""
    words = "|".join(map(re.escape, phrasebook(code).sums["behind"]))
    return re.compile(rf"\W*(?:{words})?\W*", re.IGNORECASE)


def _pattern(wording: str) -> re.Pattern[str]:
    number = NUMBER.removeprefix("-?")
    written = re.escape(wording).replace(r"\ ", r"\s*")
    for name in ("a", "b"):
        whole = rf"(?<![\d.,])(?P<{name}>{number})(?![.,]?\d)"
        written = written.replace(rf"\{{{name}\}}", whole)
    return re.compile(written, re.IGNORECASE)
