"""Questions about the kept programs: list them, or forget those that a few words name."""

import re
from collections.abc import Callable, Iterator, Sequence

from edgevox.agent.nlu.meaning import (
    After,
    BatteryBelow,
    Repeat,
    Say,
    StateIs,
    When,
    calls_of,
    is_endless,
    parts_of,
)
from edgevox.agent.nlu.order_reader import patterns_of, spelled
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.store import Kept
from edgevox.agent.text.reasons import because
from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import continued
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import ProgramStatus

_UNITS_S = (1.0, 60.0, 3600.0)


def meant(what: str, kept: Sequence[Kept], book: Phrasebook) -> Sequence[Kept] | None:
    """The programs that the words fit best; None if the words are about no program.

    Words that only say "the order" mean the only program; with several, the result is empty.
    """
    said = key(what)
    scores = [sum(_holds(said, one, book) for one in _features(each, book)) for each in kept]
    best = max(scores, default=0)
    if best:
        return [one for one, score in zip(kept, scores, strict=True) if score == best]
    if any(_holds(said, name, book) for name in book.programs.names.get("any", ())):
        return kept if len(kept) == 1 else ()
    return None


def _features(one: Kept, book: Phrasebook) -> Iterator[str]:
    """The features by which words can name a program, each with all its forms joined by bars."""
    names = book.programs.names
    for call in calls_of(one.program):
        for value in call.arguments.values():
            if isinstance(value, str):
                yield "|".join((value, *book.word(value).heard))
    if is_endless(one.program):
        yield "|".join(names.get("patrol", ()))
    for part in parts_of(one.program):
        match part:
            case After(delay_s=delay_s):
                yield "|".join(f"{delay_s / unit:g}" for unit in _UNITS_S)
            case When(condition=BatteryBelow(percent=percent)):
                yield f"{percent:g}"
                yield "|".join(names.get("battery", ()))
            case When(condition=StateIs(said=said)):
                yield said
            case Repeat(count=float() | int() as count):
                yield f"{count:g}"
            case Say(words=words):
                yield words


def _holds(said: str, forms: str, book: Phrasebook) -> bool:
    """True if the words hold one of these forms."""
    for form in filter(None, map(key, forms.split("|"))):
        if form in said and (not book.hearing.spaced or _is_whole(form, said)):
            return True
    return False


def _is_whole(form: str, said: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(form)}(?!\w)", said) is not None


_KINDS = ("list", "forget_all", "forget")


class ProgramQuestions:
    """Answers questions about programs in the language of `phrases`.

    A text for which `is_plain` returns True is a command, not a question.
    """

    def __init__(
        self,
        programs: Programs,
        *,
        phrases: Callable[[], Phrasebook],
        is_plain: Callable[[str], bool],
    ) -> None:
        self._programs = programs
        self._phrases = phrases
        self._is_plain = is_plain

    def answer(self, text: str, turn: Turn) -> bool:
        """Answer a question about the programs; False if the text is none."""
        phrases = self._phrases()
        codes = dict.fromkeys((phrases.code, ENGLISH))
        asked = [(book, *one) for book in map(phrasebook, codes) for one in _asked(text, book)]
        if not asked or self._is_plain(text):
            return False
        for book, kind, slots in asked:
            if said := _answer(kind, slots.get("what", ""), self._programs, phrases, book):
                turn.say(said)
                return True
        return False


def _answer(kind: str, what: str, programs: Programs, phrases: Phrasebook, book: Phrasebook) -> str:
    """The answer; empty if the text must mean something else."""
    kept = programs.kept
    if kind == "list":
        return listing(programs, phrases)
    some: Sequence[Kept] | None = kept if kind == "forget_all" else meant(what, kept, book)
    if some is None:
        return ""
    if not some:
        return phrases.say("program_which", orders=listing(programs, phrases))
    told = " ".join(programs.told(one) for one in some)
    programs.forget(some, because("called_off"))
    return phrases.say("program_forgotten", orders=told)


def listing(programs: Programs, phrases: Phrasebook) -> str:
    """All programs in words."""
    told = [_told(one, programs, phrases) for one in programs.kept]
    if not told:
        return phrases.say("program_none")
    return phrases.say("program_listed", orders=" ".join(told))


def _told(one: Kept, programs: Programs, phrases: Phrasebook) -> str:
    order = programs.told(one)
    if one.status is ProgramStatus.WAITING:
        return order
    return phrases.say("program_running", order=continued(order))


def _asked(text: str, book: Phrasebook) -> Sequence[tuple[str, dict[str, str]]]:
    words, patterns = spelled(text, book.code), patterns_of(book.code, _KINDS)
    found = ((kind, one.slots(words)) for kind in _KINDS for one in patterns[kind])
    return [(kind, slots) for kind, slots in found if slots is not None]
