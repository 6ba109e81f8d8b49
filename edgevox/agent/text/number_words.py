"""Number words of one language, by which `edgevox.agent.phrases.numbers` reads numbers."""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from edgevox.agent.text.spelling import NUMBER, key
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
class Lengths:
    """The units of length of one language, each a pattern with its length in metres."""

    units: tuple[tuple[re.Pattern[str], float], ...]
    """Each unit's spellings and metres."""
    several: re.Pattern[str]
    """One length or more in a row: "5 feet and 6 inches"."""
    one: re.Pattern[str]
    """A number and the unit behind it."""
    metres: str
    """The word that replaces all these units."""

    def as_metres(self, text: str) -> str:
        """The text with each length in metres, and lengths in a row as their sum.

        Of a sum each unit must be smaller than the one before: "2 metres 50 centimetres".
        """
        return self.several.sub(self._sum, text)

    def _sum(self, found: re.Match[str]) -> str:
        parts = [(float(one[1]), self._metres_of(one[2])) for one in self.one.finditer(found[0])]
        units = [unit for _, unit in parts]
        falling = all(one > other for one, other in itertools.pairwise(units))
        if len(parts) == 1 or not falling or any(number < 0 for number, _ in parts[1:]):
            return self.one.sub(self._single, found[0])
        return self._told(sum(number * unit for number, unit in parts))

    def _single(self, found: re.Match[str]) -> str:
        number, unit = found[1], self._metres_of(found[2])
        return found[0] if unit == 1.0 else self._told(float(number) * unit)

    def _told(self, metres: float) -> str:
        return f"{metres:.6g} {self.metres}"

    def _metres_of(self, unit: str) -> float:
        return next(metres for pattern, metres in self.units if pattern.fullmatch(unit))


def lengths(rows: Sequence[tuple[str, float]], metres: str, joint: str, *, spaced: bool) -> Lengths:
    """The units of a table; `joint` is the word that may stand between two lengths of a sum."""
    patterns = [(one_form(pattern), length) for pattern, length in rows]
    unit = "|".join(pattern for pattern, _ in patterns) or "(?!)"
    end = r"(?!\w)" if spaced else ""
    one = rf"{NUMBER}\s*(?:{unit}){end}"
    return Lengths(
        tuple((re.compile(pattern, re.IGNORECASE), length) for pattern, length in patterns),
        re.compile(rf"{one}(?:\s*(?:{re.escape(joint)}\s*)?{one})*", re.IGNORECASE),
        re.compile(rf"({NUMBER})\s*({unit}){end}", re.IGNORECASE),
        metres,
    )


@dataclass(frozen=True, slots=True)
class Numbers:
    """The table of numbers of a language, for `edgevox.agent.phrases.numbers`.

    `library` is the language whose number words text2num reads; empty if it knows none of these.
    """

    decimal_comma: bool = False
    rules: tuple[Rewriting, ...] = ()
    words: NumberWords | None = None
    lengths: Lengths | None = None
    library: str = ""
