"""The tables of a language's file: its numbers, and the words of sentences, answers and programs.

`edgevox.agent.phrases.numbers` reads numbers by its number words.
"""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

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
class Units:
    """The units of length or of angle of one language, each a pattern with its size."""

    units: tuple[tuple[re.Pattern[str], float], ...]
    """Each unit's spellings and its size in the base unit."""
    several: re.Pattern[str]
    """One amount or more in a row: "5 feet and 6 inches"."""
    one: re.Pattern[str]
    """A number and the unit behind it."""
    base: str
    """The word for the base unit, which replaces all these: "metres", "degrees"."""

    def converted(self, text: str) -> str:
        """The text with each amount in the base unit, and amounts in a row as their sum.

        Of a sum each unit must be smaller than the one before: "2 metres 50 centimetres".
        """
        return self.several.sub(self._sum, text)

    def _sum(self, found: re.Match[str]) -> str:
        parts = [(float(one[1]), self._size_of(one[2])) for one in self.one.finditer(found[0])]
        units = [unit for _, unit in parts]
        falling = all(one > other for one, other in itertools.pairwise(units))
        if len(parts) == 1 or not falling or any(number < 0 for number, _ in parts[1:]):
            return self.one.sub(self._single, found[0])
        return self._told(sum(number * unit for number, unit in parts))

    def _single(self, found: re.Match[str]) -> str:
        number, unit = found[1], self._size_of(found[2])
        return found[0] if unit == 1.0 else self._told(float(number) * unit)

    def _told(self, amount: float) -> str:
        return f"{amount:.6g} {self.base}"

    def _size_of(self, unit: str) -> float:
        return next(size for pattern, size in self.units if pattern.fullmatch(unit))


def units(rows: Sequence[tuple[str, float]], base: str, joint: str, *, spaced: bool) -> Units:
    """The units of a table; `joint` is the word that may stand between two amounts of a sum."""
    patterns = [(one_form(pattern), size) for pattern, size in rows]
    unit = "|".join(pattern for pattern, _ in patterns) or "(?!)"
    end = r"(?!\w)" if spaced else ""
    one = rf"{NUMBER}\s*(?:{unit}){end}"
    return Units(
        tuple((re.compile(pattern, re.IGNORECASE), size) for pattern, size in patterns),
        re.compile(rf"{one}(?:\s*(?:{re.escape(joint)}\s*)?{one})*", re.IGNORECASE),
        re.compile(rf"({NUMBER})\s*({unit}){end}", re.IGNORECASE),
        base,
    )


@dataclass(frozen=True, slots=True)
class Numbers:
    """The table of numbers of a language, for `edgevox.agent.phrases.numbers`.

    `library` is the language whose number words text2num reads; empty if it knows none of these.
    """

    decimal_comma: bool = False
    rules: tuple[Rewriting, ...] = ()
    words: NumberWords | None = None
    lengths: Units | None = None
    angles: Units | None = None
    library: str = ""


@dataclass(frozen=True, slots=True)
class Hearing:
    """The structure of sentences in a language."""

    joints: tuple[str, ...] = ()
    """Words between two commands."""
    articles: tuple[str, ...] = ()
    """Words before a name."""
    clause_words: frozenset[str] = frozenset()
    """Words that never stand in a name."""
    pair: str = "and"
    """The word to put between two bare numbers."""
    percent: str = "%"
    """The word for a percent sign after a number; "%" where it stands before the number."""
    spaced: bool = True
    """False for a script without spaces between words."""
    written: str = ""
    """Commands in the spelling of the templates, as a sample for speech recognition."""
    reserved: tuple[str, ...] = ()
    """Answers and general commands, which no place or thing may be called."""
    places: tuple[str, ...] = ()
    """Templates of usual places: "this is the charger" names one, "this is the end" does not."""
    unfinished: tuple[str, ...] = ()
    """Last words of a sentence that is not finished."""
    goes_on: tuple[str, ...] = ()
    """Examples of words that may follow a whole command: "90 degrees" after "turn left"."""
    hesitations: tuple[str, ...] = ()
    """Sounds of somebody who looks for words, each letter as long as may be: "uh"."""
    back_channels: tuple[str, ...] = ()
    """What people say while they listen, and want the speaker to go on: "mm-hm", "I see". The first
    few are compared with the sound."""
    openers: tuple[str, ...] = ()
    """Words that open a sentence and mean nothing to a robot: "and then"."""
    denials_follow: bool = False
    """True where words that deny stand behind what they deny."""


@dataclass(frozen=True, slots=True)
class AnswerWords:
    """Words of answers in a language; languages/en.toml explains each field."""

    yes: tuple[str, ...] = ()
    no: tuple[str, ...] = ()
    not_: tuple[str, ...] = ()
    drop: tuple[str, ...] = ()
    polite: tuple[str, ...] = ()
    urging: tuple[str, ...] = ()
    little: tuple[str, ...] = ()
    instead: tuple[str, ...] = ()
    or_: tuple[str, ...] = ()
    first: tuple[str, ...] = ()
    second: tuple[str, ...] = ()
    third: tuple[str, ...] = ()
    last: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ProgramPhrases:
    """The wording of programs in a language: the table `programs` of its file.

    Templates are written as those of skills: `[optional]`, `(one|or another)`, `{slot}`, `<rule>`.
    """

    templates: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Sentence templates by kind of program."""
    rules: Mapping[str, str] = field(default_factory=dict)
    """Rules that templates name."""
    rewrite: tuple[Rewriting, ...] = ()
    """Patterns and their replacements before matching: "twice" becomes "2 times"."""
    words: NumberWords | None = None
    """Number words that only programs use."""
    units: str = ""
    """Pattern of the units before which numerals count, in a language without spaces."""
    ahead: str = ""
    """Pattern of the words after which numerals count, in a language without spaces."""
    go: str = ""
    """The plain order to go to a place."""
    between: tuple[str, ...] = ()
    """Words between the places of a patrol."""
    me: tuple[str, ...] = ()
    """Words for the speaker: "tell me how full your battery is" asks, and is not to be repeated."""
    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Words for a program in an order to forget it, by kind."""


@dataclass(frozen=True, slots=True)
class Everyday:
    """An example for a model: a question, and its answer; empty for what nobody can know."""

    asked: str
    answer: str


@dataclass(frozen=True, slots=True)
class HouseAct:
    """Something that people ask of a robot in a house: languages/en.toml explains each field."""

    words: tuple[str, ...]
    cannot: str
    by: tuple[str, ...] = ()
    in_place: bool = False
    motion: bool = False
