"""Number words of one language, by which `edgevox.agent.phrases.numbers` reads numbers."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from edgevox.agent.text.spelling import key
from edgevox.core.files.text import one_form

Rewriting = tuple[re.Pattern[str], str]
"""A pattern and what it is replaced with."""


@dataclass(frozen=True, slots=True)
class NumberWords:
    """Words that are numbers, as one pattern; `values` are by the spelling of `key`."""

    pattern: re.Pattern[str]
    values: Mapping[str, float]

    def as_digits(self, text: str) -> str:
        """The text with these words as digits."""
        return self.pattern.sub(lambda match: f"{self.values[key(match[0])]:g}", text)


def number_words(words: Mapping[str, float], units: str = "") -> NumberWords | None:
    """The words of a table; None of an empty one.

    Where words have no spaces between them, they are numbers only before one of these `units`.
    """
    if not words:
        return None
    said = sorted(map(one_form, words), key=len, reverse=True)
    any_word = "|".join(map(re.escape, said))
    pattern = (
        rf"(?:{any_word})(?=\s*(?:{units}))"
        if units
        else rf"(?<!\S)(?:{any_word})(?=[\s.,;:!?\u060c\u0964]|$)"
    )
    values = {key(word): number for word, number in words.items()}
    return NumberWords(re.compile(pattern, re.IGNORECASE), values)


@dataclass(frozen=True, slots=True)
class Numbers:
    """The table of numbers of a language, for `edgevox.agent.phrases.numbers`.

    `library` is the language whose number words text2num reads; empty if it knows none of these.
    """

    decimal_comma: bool = False
    rules: tuple[Rewriting, ...] = ()
    words: NumberWords | None = None
    units: str = ""
    centimetres: str = ""
    metres: str = ""
    library: str = ""
