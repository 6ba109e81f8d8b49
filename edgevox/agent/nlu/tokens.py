"""A sentence as words, numbers and marks, in the one spelling that everything is compared in."""

import re
import unicodedata
from collections.abc import Iterable, Sequence

from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.spelling import NUMBER, folded, separated
from edgevox.core.text import one_form

Words = tuple[str, ...]

_MARKS = r"[,;.!?:\u2026\u3001\u3002\u060c\u061b\u061f\u0964]+"
_ORDINAL = r"\d+(?:st|nd|rd|th)\b"
WORD = r"(?:[^\W\d_]|[\u0900-\u0963])+'?"
"""A word; the vowels and joiners of Devanagari are no letters to `re`, and part of one."""
_TOKEN = re.compile(rf"{_ORDINAL}|(?<![\d.]){NUMBER}|{WORD}|{_MARKS}|%|\u00b0")
_IS_NUMBER = re.compile(NUMBER)
_IS_MARK = re.compile(_MARKS)
_JOINING = frozenset({0, 8, 9})
"""The combining classes of marks that make another letter or join two: kana voicing, virama."""


def plain(text: str) -> str:
    """One spelling: no accents, no vowel points, no capitals, words that a mark joins apart."""
    spelled = folded(separated(one_form(text.replace("_", " ")))).casefold()
    if spelled.isascii():
        return spelled
    return "".join(one for one in spelled if unicodedata.combining(one) in _JOINING)


def is_number(token: str) -> bool:
    """Whether this token is written in digits."""
    return bool(_IS_NUMBER.fullmatch(token))


def is_mark(token: str) -> bool:
    """Whether this token is punctuation."""
    return bool(_IS_MARK.fullmatch(token))


class Tokenizer:
    """Splits sentences of one language.

    Where words have no spaces between them the longest that is known counts, and what is not known
    falls into single characters.
    """

    def __init__(self, book: Phrasebook, known: Iterable[str]) -> None:
        self._spaced = book.hearing.spaced
        self._known = frozenset() if self._spaced else frozenset(known)
        self._longest = max(map(len, self._known), default=1)

    def __call__(self, text: str) -> Words:
        tokens = _TOKEN.findall(plain(text))
        if self._spaced:
            return tuple(tokens)
        return tuple(part for token in tokens for part in self._parts(token))

    def _parts(self, token: str) -> Sequence[str]:
        if is_number(token) or is_mark(token) or token.isascii():
            return (token,)
        parts, at = [], 0
        while at < len(token):
            length = next(
                (n for n in range(self._longest, 1, -1) if token[at : at + n] in self._known), 1
            )
            parts.append(token[at : at + length])
            at += length
        return parts


def find(tokens: Sequence[str], phrase: Words) -> list[int]:
    """Where this phrase begins among these tokens."""
    size = len(phrase)
    return [i for i in range(len(tokens) - size + 1) if tuple(tokens[i : i + size]) == phrase]
