"""Sentence templates of programs as regular expressions, whose slots are whole orders.

The recogniser of skills takes whole sentences; these take sentences apart, and what is in their
slots goes to it.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import count

from hassil.expression import (
    Alternative,
    Expression,
    ListReference,
    RuleReference,
    Sentence,
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


class Pattern:
    """One template. `text` is what `spelled` made of a sentence.

    Its expression is made when a sentence first has the words that the template cannot do without:
    to make them all takes longer than the rest of a language, and most are never asked for.
    """

    def __init__(self, shared: "_ProgramRules", template: Sentence) -> None:
        self._shared = shared
        self._template = template
        self._needed = template.get_required_clauses(shared.rules)
        self.wants_number = not NUMBERS.isdisjoint(template.list_names(shared.rules))

    def slots(self, text: str, *, anywhere: bool = False) -> dict[str, str] | None:
        """What stands in the slots if the whole text is this, or with `anywhere` a part of it."""
        read = folded(text)
        said = read.casefold()
        if not all(any(word in said for word in some) for some in self._needed):
            return None
        found = self._expression.search(read) if anywhere else self._expression.fullmatch(read)
        if found is None:
            return None
        spans = {name: found.span(name) for name, value in found.groupdict().items() if value}
        return {name.partition("__")[0]: text[slice(*span)] for name, span in spans.items()}

    @cached_property
    def _expression(self) -> re.Pattern[str]:
        written = _Writer(self._shared).write(self._template.expression)
        return re.compile(_GAP + written + _GAP, re.IGNORECASE)


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
    templates = phrasebook(code).programs.templates
    return {kind: tuple(_pattern(code, one) for one in templates.get(kind, ())) for kind in kinds}


@lru_cache
def marks_of(code: str, rules: tuple[str, ...]) -> tuple[Pattern, ...]:
    """The patterns of these rules of a language by themselves, of those that it has."""
    return tuple(_pattern(code, f"<{rule}>") for rule in rules if rule in _rules_of(code).rules)


def _pattern(code: str, template: str) -> Pattern:
    return Pattern(_rules_of(code), _parsed(template))


def number(said: str) -> float:
    """The number that a slot holds; "20 5" is twenty and five."""
    return sum(float(part) for part in said.split())


@dataclass(frozen=True, slots=True)
class _ProgramRules:
    """What the templates of a language share; `spaced`: there are spaces between its words."""

    rules: dict[str, Sentence]
    spaced: bool


@lru_cache
def _rules_of(code: str) -> _ProgramRules:
    book = phrasebook(code)
    rules = {name: _parsed(rule) for name, rule in book.programs.rules.items()}
    return _ProgramRules(rules, book.hearing.spaced)


class _Writer:
    """Writes an expression as a regular one. A slot may stand in it more than once."""

    def __init__(self, shared: _ProgramRules) -> None:
        self._rules = shared.rules
        self._spaced = shared.spaced
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
                return f"(?:{self.write(self._rules[name].expression)})"
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


def _parsed(template: str) -> Sentence:
    return parse_sentence(folded(separated(one_form(template))))
