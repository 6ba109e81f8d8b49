"""Sentence templates of programs as regular expressions, whose slots are whole orders.

The recogniser of skills takes whole sentences; these take sentences apart, and what is in their
slots goes to it.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import count

from hassil.expression import (
    Alternative,
    Expression,
    ListReference,
    RuleReference,
    Sequence,
    TextChunk,
)
from hassil.parse_expression import parse_sentence

from edgevox.agent.numbers import digits
from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.programs.numerals import rewritten
from edgevox.agent.spelling import folded, separated
from edgevox.core.text import one_form

NUMBERS = frozenset({"count", "seconds", "minutes", "hours", "percent"})
"""Slots that hold a number; all others hold words."""

_MARKS = r"\s,;:.!?\u2026\u00bf\u00a1\u060c\u061f\u061b\u0964\u3001\u3002"
_LETTER = r"\w\u0900-\u0963\u0971-\u097f"
"""Vowel signs of Devanagari are no word characters to `re`."""
_GAP = rf"[{_MARKS}]*"
_NUMBER = r"\d+(?:\.\d+)?(?: \d)?"


@dataclass(frozen=True, slots=True)
class Pattern:
    """One template. `text` is what `spelled` made of a sentence."""

    expression: re.Pattern[str]
    wants_number: bool

    def slots(self, text: str, *, anywhere: bool = False) -> dict[str, str] | None:
        """What stands in the slots if the whole text is this, or with `anywhere` a part of it."""
        find = self.expression.search if anywhere else self.expression.fullmatch
        found = find(folded(text))
        if found is None:
            return None
        spans = {name: found.span(name) for name, value in found.groupdict().items() if value}
        return {name.partition("__")[0]: text[slice(*span)] for name, span in spans.items()}


@lru_cache(maxsize=8)
def spelled(text: str, code: str) -> str:
    """A sentence of a language as its patterns read it, with its numbers as digits.

    Whoever looks for a program, and for a question about one, asks for the same sentence.
    """
    plainly = digits(" ".join(text.split()), code)
    return rewritten(_prepared(plainly), phrasebook(code).programs)


@lru_cache
def patterns_of(code: str, kinds: tuple[str, ...]) -> Mapping[str, tuple[Pattern, ...]]:
    """The patterns of a language by these kinds of its templates."""
    book = phrasebook(code)
    spaced, rules, templates = book.hearing.spaced, book.programs.rules, book.programs.templates
    return {
        kind: tuple(compiled(one, rules, spaced=spaced) for one in templates.get(kind, ()))
        for kind in kinds
    }


def compiled(template: str, rules: Mapping[str, str], *, spaced: bool) -> Pattern:
    """The pattern of a template; `spaced` is False where words have no spaces between them."""
    written = _Writer(rules, spaced=spaced).write(parse_sentence(_folded(template)).expression)
    wants_number = any(f"(?P<{name}__" in written for name in NUMBERS)
    return Pattern(re.compile(_GAP + written + _GAP, re.IGNORECASE), wants_number)


def number(said: str) -> float:
    """The number that a slot holds; "20 5" is twenty and five."""
    return sum(float(part) for part in said.split())


class _Writer:
    """Writes an expression as a regular one. A slot may stand in it more than once."""

    def __init__(self, rules: Mapping[str, str], *, spaced: bool) -> None:
        self._rules = rules
        self._spaced = spaced
        self._numbers = count(1)

    def write(self, part: Expression) -> str:
        match part:
            case TextChunk():
                return self._words(part.original_text)
            case Alternative():
                return f"(?:{'|'.join(self.write(item) for item in part.items)})"
            case Sequence():
                return "".join(self.write(item) for item in part.items)
            case ListReference(list_name=name):
                return self._slot(name)
            case RuleReference(rule_name=name):
                rule = parse_sentence(_folded(self._rules[name]))
                return f"(?:{self.write(rule.expression)})"
        raise TypeError(part)

    def _slot(self, name: str) -> str:
        inside = _NUMBER if name in NUMBERS else rf"[^{_MARKS}](?:.*?[^{_MARKS}])??"
        before, after = (rf"(?<![{_LETTER}])", rf"(?![{_LETTER}])") if self._spaced else ("", "")
        if name in NUMBERS:
            before, after = r"(?<![\d.])", r"(?!\.?\d)"
        return f"{_GAP}{before}(?P<{name}__{next(self._numbers)}>{inside}){after}{_GAP}"

    def _words(self, text: str) -> str:
        return "".join(
            _GAP if piece.isspace() else self._word(piece)
            for piece in re.split(r"(\s+)", text)
            if piece
        )

    def _word(self, word: str) -> str:
        if not self._spaced:
            return re.escape(word)
        before = rf"(?<![{_LETTER}])" if re.match(f"[{_LETTER}]", word[0]) else ""
        after = rf"(?![{_LETTER}])" if re.match(f"[{_LETTER}]", word[-1]) else ""
        return before + re.escape(word) + after


def _prepared(text: str) -> str:
    """A text as patterns read it: letters, accents and apostrophes in one form."""
    return " ".join(separated(one_form(text)).split()).strip(" .,;:!?\u3002\u0964\u061f")


def _folded(template: str) -> str:
    return folded(separated(one_form(template)))
