"""The reader of programs in sentences, by templates alone: no language model ever makes one.

The templates become regular expressions whose slots are whole orders: they take a sentence apart,
and the recogniser of skills reads each order. `rewritten` turns number words that only programs use
into digits: "twice", "half an hour", 五分.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import count
from types import MappingProxyType

from hassil import expression
from hassil.expression import (
    Alternative,
    Expression,
    ListReference,
    RuleReference,
    Sentence,
    TextChunk,
)
from hassil.parse_expression import parse_sentence

from edgevox.agent.known import VALUE, StateCondition
from edgevox.agent.nlu.meaning import (
    After,
    Again,
    Arrived,
    BatteryBelow,
    Do,
    Pause,
    Program,
    Repeat,
    Return,
    Say,
    StateIs,
    Steps,
    When,
    parts_of,
)
from edgevox.agent.nlu.templates import MAX_CHARACTERS, RefusedCommand
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.phrases.tables import ProgramPhrases
from edgevox.agent.skills import Call
from edgevox.agent.text.spelling import folded, separated
from edgevox.core.files.text import one_form

_DIGITS = {character: value for value, character in enumerate("零一二三四五六七八九")}
_DIGITS |= {"\N{IDEOGRAPHIC NUMBER ZERO}": 0, "两": 2, "兩": 2}
_TENS = {"十": 10, "百": 100}
_NUMERAL = f"[{''.join(_DIGITS)}{''.join(_TENS)}]+"


def rewritten(text: str, phrases: ProgramPhrases) -> str:
    """The text with program numbers as digits, and with the language's rewritings."""
    if phrases.units:
        ahead = f"(?<={phrases.ahead}){_NUMERAL}|(?!{phrases.ahead})" if phrases.ahead else ""
        numerals = rf"{ahead}{_NUMERAL}(?=\s*(?:{phrases.units}))"
        text = re.sub(numerals, lambda match: str(numeral(match[0])), text)
    if phrases.words:
        text = phrases.words.as_digits(text)
    for pattern, replacement in phrases.rewrite:
        text = pattern.sub(replacement, text)
    return text


def numeral(written: str) -> int:
    """The value of a Chinese or Japanese numeral up to 999."""
    total, current = 0, 0
    for character in written:
        if character in _TENS:
            total += (current or 1) * _TENS[character]
            current = 0
        else:
            current = _DIGITS[character]
    return total + current


NUMBERS = frozenset({"count", "seconds", "minutes", "hours", "percent", VALUE})
"""Slots that hold a number; all others hold words."""

_CONDITION = "condition"
"""The rule for a condition of the robot, whose words are told to the person."""
_PUNCTUATION = r"\s,;:.!?\u2026\u00bf\u00a1\u060c\u061f\u061b\u0964\u3001\u3002"
_LETTER = r"\w\u0900-\u0963\u0971-\u097f"
"""Vowel signs of Devanagari are no word characters to `re`."""
_GAP = rf"[{_PUNCTUATION}]*"
_NUMBER = r"(?:\d*[1-9]0 [1-9]|\d+(?:\.\d+)?)"
_AMOUNT = re.compile(r"-?\d+(?:\.\d+)?\s*[^\W\d]*")
"""A number alone, or with its unit."""
_TIME = r"\d{1,2}[:.]\d{2}"


class Pattern:
    """One template as a regular expression.

    The expression is built when a sentence first holds the words that the template requires:
    building all takes longer than the rest of a language, and most are never needed.
    """

    def __init__(self, shared: "_ProgramRules", template: Sentence) -> None:
        self._shared = shared
        self._template = template
        self._needed = template.get_required_clauses(shared.rules)
        self.wants_number = not NUMBERS.isdisjoint(template.list_names(shared.rules))

    def slots(self, text: str, *, anywhere: bool = False) -> dict[str, str] | None:
        """The slots' contents if the template fits the whole text; with `anywhere`, a part of it.

        `text` must come from `spelled`.
        """
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
    """A sentence as the patterns of a language read it, with its numbers as digits.

    Cached: the readers of programs and of questions about programs ask for the same sentence.
    """
    plainly = digits(" ".join(text.split()), code)
    return rewritten(_prepared(plainly), phrasebook(code).programs)


@lru_cache
def patterns_of(code: str, kinds: tuple[str, ...]) -> Mapping[str, tuple[Pattern, ...]]:
    """The patterns of a language for these kinds of templates."""
    templates = phrasebook(code).programs.templates
    return {
        kind: tuple(_pattern(code, one) for one in templates.get(kind, ()))
        for kind in kinds
        if kind != _WHEN
    }


@lru_cache
def marks_of(code: str, rules: tuple[str, ...]) -> tuple[Pattern, ...]:
    """The patterns of these rules alone, as far as the language has them."""
    return tuple(_pattern(code, f"<{rule}>") for rule in rules if rule in _rules_of(code).rules)


def _pattern(code: str, template: str) -> Pattern:
    return Pattern(_rules_of(code), _parsed(template))


def number(said: str) -> float:
    """The number in a slot; "20 5" is twenty plus five."""
    return sum(float(part) for part in said.split())


@dataclass(frozen=True, slots=True)
class _ProgramRules:
    """Rules that the templates of a language share; `spaced` if it puts spaces between words."""

    rules: dict[str, Sentence]
    spaced: bool


@lru_cache
def _rules_of(code: str) -> _ProgramRules:
    book = phrasebook(code)
    rules = {name: _parsed(rule) for name, rule in book.programs.rules.items()}
    return _ProgramRules(rules, book.hearing.spaced)


class _Writer:
    """Writes a template expression as a regular expression, which may repeat a slot."""

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
            case expression.Sequence():
                return "".join(self.write(item) for item in part.items)
            case ListReference(list_name=name):
                return self._slot(name)
            case RuleReference(rule_name=name):
                group = f"?P<{name}__{next(self._numbers)}>" if name == _CONDITION else "?:"
                return f"({group}{self.write(self._rules[name].expression)})"
        raise TypeError(part)

    def _slot(self, name: str) -> str:
        inside = _TIME if name == "time" else rf"[^{_PUNCTUATION}](?:.*?[^{_PUNCTUATION}])??"
        before, after = (rf"(?<![{_LETTER}])", rf"(?![{_LETTER}])") if self._spaced else ("", "")
        if name in NUMBERS:
            inside, before, after = _NUMBER, r"(?<![\d.])", r"(?!\.?\d)"
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
    """A text with letters, accents and apostrophes in one form, without outer punctuation."""
    return " ".join(separated(one_form(text)).split()).strip(" .,;:!?\u3002\u0964\u061f")


def _parsed(template: str) -> Sentence:
    return parse_sentence(folded(separated(one_form(template))))


Plain = Callable[[str], Sequence[Call] | RefusedCommand | None]
"""Reads a plain command by the templates of the skills: its calls, a refusal, or None."""

DEEPEST = 4
"""Number of wrappers that one sentence may have around a plain command."""
_SECONDS = {"hours": 3600.0, "minutes": 60.0, "seconds": 1.0}
_WHEN = "when"
"""The wrapper of an order that waits for a condition of the robot."""
_CLOCK = "clock"
"""The wrapper of an order for a time of day, or for every hour: it is refused."""
_KINDS = (
    "low",
    _WHEN,
    "wait",
    "after",
    "until",
    "times",
    "arrived",
    "saying",
    "back",
    "patrol",
    "say",
    _CLOCK,
)
"""The kinds of wrappers, the outermost first."""
_MARKS = ("later", "low", "empty")
"""Rules that mark an order for later."""
_AT_ONCE = ("until", "times", "arrived", "saying", "back")
"""Wrappers around orders for now: no order inside may wait for its time."""


@dataclass(frozen=True, slots=True)
class Unclear:
    """An order for later whose inner order is no plain command."""


Read = Program | RefusedCommand | Unclear | None


NO_CONDITIONS: Mapping[str, StateCondition] = MappingProxyType({})


class ProgramReader:
    """Reads programs in sentences of one language and of English."""

    def __init__(
        self, language: str = ENGLISH, conditions: Mapping[str, StateCondition] = NO_CONDITIONS
    ) -> None:
        self._language = language
        codes = dict.fromkeys((language, ENGLISH))
        self._languages = [_ProgramLanguage(phrasebook(code), conditions) for code in codes]

    def understand(self, text: str, plain: Plain, free: Plain) -> tuple[Read, bool]:
        """The result of `read`, and whether it comes from templates alone.

        If `plain` reads no program, `free` reads the inner orders: it knows more words and is less
        sure. A mere sequence of orders that only `free` reads is left to the reading of sentences.
        """
        strict = self.read(text, plain)
        if isinstance(strict, Program):
            return strict, True
        loose = self.read(text, free)
        if isinstance(loose, Program) and not _is_joined(loose):
            return loose, False
        return strict, True

    def read(self, text: str, plain: Plain) -> Read:
        """The program of a sentence that is no plain command; None if it holds none."""
        if len(text) > MAX_CHARACTERS:
            return None
        exact = is_exact(text, self._language)
        found: Read = None
        for language in self._languages:
            read = language.whole(text, plain) if exact else language.at_a_time(text, plain)
            if read is not None and not isinstance(read, RefusedCommand | Unclear):
                return read
            found = found or read
        return found


class _ProgramLanguage:
    """The templates of one phrasebook."""

    def __init__(self, book: Phrasebook, conditions: Mapping[str, StateCondition]) -> None:
        self._book = book
        self._conditions = [
            (name, *_waits_for(book, one.sentences[book.code]))
            for name, one in conditions.items()
            if one.sentences.get(book.code)
        ]
        phrases, spaced = book.programs, book.hearing.spaced
        self._patterns = patterns_of(book.code, _KINDS)
        self._marks = marks_of(book.code, _MARKS)
        between = [re.escape(word) for word in phrases.between]
        joint = "|".join(rf"\s+{word}\s+" if spaced else word for word in between) or "(?!)"
        self._between = re.compile(rf"\s*[,\u3001\u060c]\s*(?:{joint})?|{joint}", re.IGNORECASE)

    def whole(self, text: str, plain: Plain) -> Read:
        """The program of the whole text."""
        words = spelled(text, self._book.code)
        read = self._wrapped(words, plain, DEEPEST)
        if isinstance(read, Say):
            return None
        return Unclear() if read is None and self._is_later(words) else read

    def at_a_time(self, text: str, plain: Plain) -> RefusedCommand | None:
        """The refusal of an order for a time of day: "at 17:30, go to the kitchen"."""
        words = spelled(text, self._book.code)
        for pattern in self._patterns[_CLOCK]:
            if (slots := pattern.slots(words)) is not None:
                return self._for_a_time(slots, plain)
        return None

    def _for_a_time(self, slots: dict[str, str], plain: Plain) -> RefusedCommand | None:
        order = plain(self._order(slots))
        return RefusedCommand(self._book.say("program_clock")) if order else None

    def _is_later(self, words: str) -> bool:
        marks = (*self._marks, *(mark for _, _, mark in self._conditions))
        return any(mark.slots(words, anywhere=True) is not None for mark in marks)

    def _read(self, words: str, plain: Plain, left: int) -> Program | RefusedCommand | None:
        calls = plain(words)
        if isinstance(calls, Sequence):
            return Do(tuple(calls))
        return self._wrapped(words, plain, left) or calls

    def _wrapped(self, words: str, plain: Plain, left: int) -> Program | RefusedCommand | None:
        refused: RefusedCommand | None = None
        for kind, slots in self._matches(words) if left else ():
            found = self._built(kind, slots, plain, left - 1)
            if found is not None and not isinstance(found, RefusedCommand):
                return found
            refused = refused or found
        return refused

    def _matches(self, words: str) -> Iterator[tuple[str, dict[str, str]]]:
        has_number = any(character.isdigit() for character in words)
        for kind in _KINDS:
            if kind == _WHEN:
                yield from self._conditions_in(words)
                continue
            for pattern in self._patterns[kind]:
                if has_number or kind == _CLOCK or not pattern.wants_number:
                    slots = pattern.slots(words)
                    if slots is not None:
                        yield kind, slots

    def _conditions_in(self, words: str) -> Iterator[tuple[str, dict[str, str]]]:
        for name, patterns, _ in self._conditions:
            for pattern in patterns:
                if slots := pattern.slots(words):
                    yield _WHEN, {**slots, _NAME: name}

    def _built(
        self, kind: str, slots: dict[str, str], plain: Plain, left: int
    ) -> Program | RefusedCommand | None:
        if kind == _CLOCK:
            return self._for_a_time(slots, plain)
        if kind == "say":
            return self._said(slots["words"])
        if kind == "patrol":
            return self._patrol(slots["places"], plain)
        if kind == "wait":
            return self._with_pause(slots, plain, left)
        order = self._read(self._order(slots), plain, left) if "order" in slots else Again()
        if order is None or isinstance(order, RefusedCommand):
            return order
        if kind in _AT_ONCE and _waits(order) and order != Again():
            return None
        if kind in ("arrived", "saying"):
            return self._then(order, slots, plain, left)
        return _around(kind, order, slots)

    def _order(self, slots: dict[str, str]) -> str:
        """The inner order, even if the wrapper stands in the middle of it."""
        space = " " if self._book.hearing.spaced else ""
        return space.join(slots[name] for name in ("order", "rest") if name in slots)

    def _with_pause(
        self, slots: dict[str, str], plain: Plain, left: int
    ) -> Program | RefusedCommand | None:
        """One order, a pause, and one more order, if anything follows."""
        first = self._read(slots["order"], plain, left)
        if not isinstance(first, Do) or len(first.calls) != 1:
            return first if isinstance(first, RefusedCommand) else None
        pause = Pause(_seconds(slots.items()))
        if "next" not in slots:
            return Steps((first, pause))
        space = " " if self._book.hearing.spaced else ""
        both = self._read(space.join((slots["order"], slots["next"])), plain, left)
        match both:  # "... and come back" says what it means only behind the order
            case Steps(steps=(before, after)):
                return Steps((before, pause, after))
            case Do(calls=(call, last)):
                return Steps((Do((call,)), pause, Do((last,))))
        then = self._read(slots["next"], plain, left)
        if isinstance(then, Do) and len(then.calls) == 1:
            return Steps((first, pause, then))
        return then if isinstance(then, RefusedCommand) else None

    def _then(
        self, order: Program, slots: dict[str, str], plain: Plain, left: int
    ) -> Program | RefusedCommand | None:
        """Two orders in sequence; after "when you are there" the second waits for the motion."""
        if "words" in slots and _AMOUNT.fullmatch(slots["words"].strip()):
            return None  # "turn right, say 20 degrees"
        after: Program | RefusedCommand | None = (
            self._said(slots["words"])
            if "words" in slots
            else self._read(slots["next"], plain, left)
        )
        if after is None or isinstance(after, RefusedCommand):
            return after
        if order == Again():
            return When(Arrived(), after)
        return None if _waits(after) else Steps((order, after))

    def _said(self, words: str) -> Say | None:
        """The words to say aloud; None if the person wants to be told something."""
        asked = words.split(" ", maxsplit=1)[0].casefold() in self._book.programs.me
        return None if asked else Say(words.replace("' ", "'"))

    def _patrol(self, places: str, plain: Plain) -> Program | RefusedCommand | None:
        """A patrol of these places, until it is stopped."""
        calls: list[Call] = []
        for place in filter(None, map(str.strip, self._between.split(places))):
            found = plain(self._book.programs.go.replace("{place}", place))
            if not isinstance(found, Sequence):
                return found
            calls += found
        return Repeat(Do(tuple(calls)), None) if len(calls) > 1 else None


_NAME = "name"
LOW_PERCENT = 20.0
"""The charge below which a battery is low, where no number is said; the answer names it."""


def _waits_for(book: Phrasebook, sentences: Sequence[str]) -> tuple[list[Pattern], Pattern]:
    """The patterns of orders that wait for this condition, and the one that marks them."""
    shared = _rules_of(book.code)
    rules = {**shared.rules, _CONDITION: _parsed(f"({'|'.join(sentences)})")}
    own = _ProgramRules(rules, shared.spaced)
    slot, rule = f"{{{_CONDITION}}}", f"<{_CONDITION}>"
    written = [one.replace(slot, rule) for one in book.programs.templates.get(_WHEN, ())]
    orders = [Pattern(own, _parsed(one)) for one in written]
    return orders, Pattern(own, _parsed(f"<{_WHEN}>" + " " * shared.spaced + f"<{_CONDITION}>"))


def _around(kind: str, order: Program, slots: dict[str, str]) -> Program:
    match kind:
        case "after":
            return After(_seconds(slots.items()), order)
        case "low":
            percent = number(slots["percent"]) if "percent" in slots else LOW_PERCENT
            return When(BatteryBelow(percent), order)
        case "when":
            value = number(slots[VALUE]) if VALUE in slots else None
            return When(StateIs(slots[_NAME], slots[_CONDITION].strip(), value), order)
        case "until":
            return Repeat(_once(order), None)
        case "times":
            return Repeat(_once(order), number(slots["count"]))
    return Steps((order, Return()))


def _waits(program: Program) -> bool:
    return any(isinstance(one, After | When) for one in parts_of(program))


def _is_joined(program: Program) -> bool:
    return all(isinstance(one, Do | Return | Steps) for one in parts_of(program))


def _once(order: Program) -> Program:
    """The program without its own endless repetition: a patrol may be made three times."""
    return order.program if isinstance(order, Repeat) and order.count is None else order


def _seconds(slots: Iterable[tuple[str, str]]) -> float:
    return sum(number(said) * _SECONDS[name] for name, said in slots if name in _SECONDS)
