"""Sums with two numbers, which a small language model often gets wrong: "what is 17 times 12"."""

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache

from edgevox.agent.nlu.questions import asks
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.text.spelling import NUMBER

_MOST = 10**12
_DECIMALS = 2
_MOST_IN_FRONT = 4
"""Number of words in front of a sum: "how much is a hundred" has four in digits."""
_A_NUMBER = re.compile(r"\d+(?:[.,]\d+)*")
_THOUSANDS = re.compile(r"\d[.,]\d{3}(?!\d)")
"""A number that is a thousand times as large in some languages as in others."""

_SUMS: Mapping[str, Callable[[Fraction, Fraction], Fraction]] = {
    "plus": lambda a, b: a + b,
    "minus": lambda a, b: a - b,
    "times": lambda a, b: a * b,
    "over": lambda a, b: a / b,
    "percent": lambda a, b: a * b / 100,
}


def answer_to_sum(text: str, code: str) -> str:
    """The answer to the one sum in a text, in this language; empty for any other text.

    The wordings of sums are in `[sums]` of a language. The text has no number beside the two, no
    sign before them, and nothing but a few words that ask for the result around them.
    """
    plain = " ".join(text.split())
    if _THOUSANDS.search(plain):
        return ""
    for said in (plain, digits(plain, code)):
        for name, pattern, numbers in _patterns(code):
            found = pattern.search(said)
            if found is None or len(_A_NUMBER.findall(said)) != numbers:
                continue
            if _is_asked_for(found, text, code):
                return _told(name, Fraction(found["a"]), Fraction(found["b"]), phrasebook(code))
    return ""


def _is_asked_for(found: re.Match[str], text: str, code: str) -> bool:
    front, sums = found.string[: found.start()].rstrip(), phrasebook(code).sums
    behind = _behind(code).fullmatch(found.string, found.end())
    signs = ("-", "\u2212", *(one[len("{a}") : -len("{b}")].strip() for one in sums["minus"]))
    words = front.split() if phrasebook(code).hearing.spaced else front
    if behind is None or front.casefold().endswith(signs) or len(words) > _MOST_IN_FRONT:
        return False
    return not front or bool(behind[1]) or asks(text, code)


def _told(name: str, a: Fraction, b: Fraction, book: Phrasebook) -> str:
    if name == "over" and b == 0:
        return ""
    value = _SUMS[name](a, b)
    result = round(value, _DECIMALS)
    if abs(value) > _MOST or (value and not result):
        return ""
    told = "sum" if result == value else "sum_about"
    return book.say(told, result=f"{float(result):.15g}")


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
    return re.compile(rf"\W*({words})?\W*", re.IGNORECASE)


def _pattern(wording: str) -> re.Pattern[str]:
    number = NUMBER.removeprefix("-?")
    written = re.escape(wording).replace(r"\ ", r"\s*")
    for name in ("a", "b"):
        whole = rf"(?<![\d.,])(?P<{name}>{number})(?![.,]?\d)"
        written = written.replace(rf"\{{{name}\}}", whole)
    return re.compile(written, re.IGNORECASE)
