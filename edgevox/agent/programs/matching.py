"""Which programs somebody means who says a few words of one."""

import re
from collections.abc import Iterator, Sequence

from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.programs.kept import Kept
from edgevox.agent.programs.program import (
    After,
    BatteryBelow,
    Repeat,
    Say,
    When,
    calls_of,
    is_endless,
    parts_of,
)
from edgevox.agent.spelling import key

_UNITS_S = (1.0, 60.0, 3600.0)


def meant(what: str, kept: Sequence[Kept], book: Phrasebook) -> Sequence[Kept] | None:
    """Those of which most is said; None if nothing that is said is about any.

    Where only "the order" is said, it is the only one there is, or nobody knows which: empty.
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
    """What may be said of a program, each of it in all its forms, joined by bars."""
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
            case Repeat(count=float() | int() as count):
                yield f"{count:g}"
            case Say(words=words):
                yield words


def _holds(said: str, forms: str, book: Phrasebook) -> bool:
    """Whether one of these forms is in what was said."""
    for form in filter(None, map(key, forms.split("|"))):
        if form in said and (not book.hearing.spaced or _is_whole(form, said)):
            return True
    return False


def _is_whole(form: str, said: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(form)}(?!\w)", said) is not None
