"""Reads programs out of sentences, by templates alone: no language model ever makes one."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.templates import MAX_CHARACTERS, RefusedCommand
from edgevox.agent.numbers import is_exact
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.programs.patterns import marks_of, number, patterns_of, spelled
from edgevox.agent.programs.program import (
    After,
    Again,
    Arrived,
    BatteryBelow,
    Do,
    Program,
    Repeat,
    Return,
    Say,
    Steps,
    When,
    parts_of,
)
from edgevox.agent.skills import Call

Plain = Callable[[str], Sequence[Call] | RefusedCommand | None]
"""The calls that a plain command is, by the templates of the skills."""

DEEPEST = 4
"""How many wrappers one sentence may have around a plain command."""
_SECONDS = {"hours": 3600.0, "minutes": 60.0, "seconds": 1.0}
_KINDS = ("low", "after", "until", "times", "arrived", "saying", "back", "patrol", "say")
"""The kinds of wrappers, the outermost first."""
_MARKS = ("later", "low")
"""The rules that tell that an order is for later."""
_AT_ONCE = ("until", "times", "arrived", "saying", "back")
"""Wrappers around what is done on the spot: nothing in them may wait for its time."""


@dataclass(frozen=True, slots=True)
class Unclear:
    """An order for later whose inside is no plain command."""


Read = Program | RefusedCommand | Unclear | None


class ProgramReader:
    """Reads the sentences of one language, and English ones."""

    def __init__(self, language: str = ENGLISH) -> None:
        self._language = language
        codes = dict.fromkeys((language, ENGLISH))
        self._languages = [_ProgramLanguage(phrasebook(code)) for code in codes]

    def understand(self, text: str, plain: Plain, free: Plain) -> tuple[Read, bool]:
        """As `read`, and whether the templates alone say so.

        Only where they do not, `free` reads what stands inside, which knows more words than
        `plain` and is less sure; what is only one after another is a reading by itself.
        """
        strict = self.read(text, plain)
        if isinstance(strict, Program):
            return strict, True
        loose = self.read(text, free)
        if isinstance(loose, Program) and not _is_joined(loose):
            return loose, False
        return strict, True

    def read(self, text: str, plain: Plain) -> Read:
        """The program that a sentence is; None for none. It is no plain command by itself."""
        if len(text) > MAX_CHARACTERS or not is_exact(text, self._language):
            return None
        found: Read = None
        for language in self._languages:
            read = language.whole(text, plain)
            if read is not None and not isinstance(read, RefusedCommand | Unclear):
                return read
            found = found or read
        return found


class _ProgramLanguage:
    """The templates of one phrasebook."""

    def __init__(self, book: Phrasebook) -> None:
        self._book = book
        phrases, spaced = book.programs, book.hearing.spaced
        self._patterns = patterns_of(book.code, _KINDS)
        self._marks = marks_of(book.code, _MARKS)
        between = [re.escape(word) for word in phrases.between]
        joint = "|".join(rf"\s+{word}\s+" if spaced else word for word in between) or "(?!)"
        self._between = re.compile(rf"\s*[,\u3001\u060c]\s*(?:{joint})?|{joint}", re.IGNORECASE)

    def whole(self, text: str, plain: Plain) -> Read:
        """What all of it is."""
        words = spelled(text, self._book.code)
        read = self._wrapped(words, plain, DEEPEST)
        if isinstance(read, Say):
            return None
        return Unclear() if read is None and self._is_later(words) else read

    def _is_later(self, words: str) -> bool:
        return any(mark.slots(words, anywhere=True) is not None for mark in self._marks)

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
            for pattern in self._patterns[kind]:
                if has_number or not pattern.wants_number:
                    slots = pattern.slots(words)
                    if slots is not None:
                        yield kind, slots

    def _built(
        self, kind: str, slots: dict[str, str], plain: Plain, left: int
    ) -> Program | RefusedCommand | None:
        if kind == "say":
            return self._said(slots["words"])
        if kind == "patrol":
            return self._patrol(slots["places"], plain)
        order = self._read(self._order(slots), plain, left) if "order" in slots else Again()
        if order is None or isinstance(order, RefusedCommand):
            return order
        if kind in _AT_ONCE and _waits(order) and order != Again():
            return None
        if kind in ("arrived", "saying"):
            return self._then(order, slots, plain, left)
        return _around(kind, order, slots)

    def _order(self, slots: dict[str, str]) -> str:
        """The order, also where the wrapper stands in the middle of it."""
        space = " " if self._book.hearing.spaced else ""
        return space.join(slots[name] for name in ("order", "rest") if name in slots)

    def _then(
        self, order: Program, slots: dict[str, str], plain: Plain, left: int
    ) -> Program | RefusedCommand | None:
        """One after another; what is said of an order that is under way waits for its end."""
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
        """What is to be said aloud; None of what somebody wants to be told."""
        asked = words.split(" ", maxsplit=1)[0].casefold() in self._book.programs.me
        return None if asked else Say(words.replace("' ", "'"))

    def _patrol(self, places: str, plain: Plain) -> Program | RefusedCommand | None:
        """To each of these places in turn, until it is stopped."""
        calls: list[Call] = []
        for place in filter(None, map(str.strip, self._between.split(places))):
            found = plain(self._book.programs.go.replace("{place}", place))
            if not isinstance(found, Sequence):
                return found
            calls += found
        return Repeat(Do(tuple(calls)), None) if len(calls) > 1 else None


def _around(kind: str, order: Program, slots: dict[str, str]) -> Program:
    match kind:
        case "after":
            return After(_seconds(slots.items()), order)
        case "low":
            return When(BatteryBelow(number(slots["percent"])), order)
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
    """Without the end that it had of its own: a patrol may be made three times."""
    return order.program if isinstance(order, Repeat) and order.count is None else order


def _seconds(slots: Iterable[tuple[str, str]]) -> float:
    return sum(number(said) * _SECONDS[name] for name, said in slots if name in _SECONDS)
