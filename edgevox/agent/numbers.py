"""Numbers as people say them, written as digits: small models get them wrong."""

import re
from collections.abc import Callable

from text_to_num import alpha2digit

SPOKEN_LANGUAGES = frozenset({"en", "fr", "es", "pt", "de", "nl", "it"})
"""Languages whose number words are understood; digits are understood in every language."""

_NUMBER = r"-?\d+(?:\.\d+)?"
_Rule = tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]]


def _metres(match: re.Match[str]) -> str:
    return f"{float(match.group(1)) / 100:g} meters"


_ENGLISH: tuple[_Rule, ...] = (
    (re.compile(r"\b(?:minus|negative) (\d)"), r"-\1"),
    (re.compile(r"\b(\d+) and (?:a|1) half\b"), r"\1.5"),
    (re.compile(r"\b(\d+) and (?:a|1) quarter\b"), r"\1.25"),
    (re.compile(r"\b(?:a |1 )?half (?:a |an |of a )?(?=met(?:er|re)|turn)"), "0.5 "),
    (re.compile(r"\b(?:a |1 )?quarter (?:of a |a )?(?=met(?:er|re)|turn)"), "0.25 "),
    (re.compile(rf"({_NUMBER}) ?(?:centimet(?:er|re)s?|cm)\b"), _metres),
)


def digits(text: str, language: str = "en") -> str:
    """The same text with its number words as digits: "minus two and a half" becomes "-2.5".

    English fractions and centimetres become decimals and metres.
    """
    if language in SPOKEN_LANGUAGES:
        text = str(alpha2digit(text, language, 0))
    if language == "en":
        for pattern, replacement in _ENGLISH:
            text = pattern.sub(replacement, text)
    return text
