"""Texts split into clauses: at marks, and before words that join one to another.

"Back up a metre, you're blocking the door" has two, "go there, then turn left" also two.
"""

import re
from collections.abc import Sequence
from functools import cache

from edgevox.agent.nlu.evidence import QUESTION_MARKS
from edgevox.agent.nlu.lexicon import Lexicon, plain, words_of
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.languages import LANGUAGES

_MARKS = re.compile(
    r"[,;:.!?\u2026\u060c\u061b\u061f\u0964]+(?=\s|$)"
    r"|[\u3001\u3002\uff01\uff0c\uff1f]|\s[-\u2013\u2014]+\s"
    r"|(?<=[\u3040-\u9fff])[,;:.!?]+(?=[\u3040-\u9fff])"
)


def clauses_of(text: str, code: str, more: tuple[str, ...] = ()) -> Sequence[str]:
    """The clauses of a text: it is parted at marks, before words that open a reason, and `more`."""
    before = _opening((*words_of(code).reasons, *more), spaced=LANGUAGES[code].spaced)
    pieces = [part.strip() for one in _MARKS.split(text) for part in before.split(one.strip())]
    return [one for one in pieces if plain(one).strip()]


@cache
def _opening(words: tuple[str, ...], *, spaced: bool) -> re.Pattern[str]:
    """What stands before any of these words; nothing does without one.

    In a language without spaces a word of one sign may be a part of another one.
    """
    said = [one for one in sorted(words, key=len)[::-1] if spaced or len(one) > 1]
    either = "|".join(map(re.escape, said)) or "(?!)"
    ends = r"(?![\w\u0900-\u097f])"
    opens = rf"\s(?=(?:{either}){ends})" if spaced else rf"(?<=.)(?={either})"
    return re.compile(opens, re.IGNORECASE)


def is_taken_back(text: str, lexicon: Lexicon) -> bool:
    """True if the text ends in words that take back what is before them: "..., actually no".

    A question mark makes a tag of such words: "ve a la cocina, ¿no?".
    """
    words, book = lexicon.function_words, lexicon.book
    if text.rstrip().endswith(tuple(QUESTION_MARKS)):
        return False
    filling = (*words.fillers, *words.urges, *book.hearing.joints)
    small = lexicon.index((*book.answers.no, *words.corrections, *filling))
    said = [one for one in _MARKS.split(text) if plain(one).strip()]
    clauses = [lexicon.tokenize(one) for one in said]
    meant = [not small.places(one).issuperset(range(len(one))) for one in clauses]
    if not any(meant):
        return False
    if len(said) > 1 and any(meant[:-1]) and find_stop_word(book.code, said[-1]):
        return True
    last = clauses[-1]
    declined = [*lexicon.outside(book.answers.no, filling, last)]
    if not meant[-1]:
        return bool(declined)
    correcting = lexicon.index(words.corrections).places(last)
    return any(one.stop == len(last) and one.start - 1 in correcting for one in declined)


def unjoined(clause: str, joints: Sequence[str], code: str) -> str:
    """The clause without the word that joins it to the one before: "then forward", "so go"."""
    space = " " if LANGUAGES[code].spaced else ""
    for one in sorted((*joints, *words_of(code).results), key=len)[::-1]:
        if clause.casefold().startswith(f"{one}{space}") and (space or len(one) > 1):
            return clause[len(one) :].strip()
    return clause


def without_joint(text: str, joints: Sequence[str], code: str) -> str:
    """The text without the word that joins it to what follows: "go there and"; "" without one."""
    space = " " if LANGUAGES[code].spaced else ""
    bare = text.rstrip(" ,")
    ends = [one for one in joints if bare.casefold().endswith(f"{space}{one}")]
    return bare[: -len(max(ends, key=len))].rstrip(" ,") if ends else ""
