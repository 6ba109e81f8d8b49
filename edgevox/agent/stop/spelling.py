"""Splitting of a text into folded words, so that any spelling of a stop word is found.

People shout, type without accents, lengthen letters and spell words out; attackers hide characters
and use letters that look alike. This module folds all of that, for stop words only.
"""

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

from confusable_homoglyphs.confusables import confusables_data

from edgevox.agent.text.spelling import TYPED_ALIKE
from edgevox.core.files.text import one_form, without_hidden
from edgevox.core.languages import STOP_SIGNS

_HYPHENS = "-_\N{HYPHEN}\N{NON-BREAKING HYPHEN}"
_ELISION = re.compile(r"^(\w{1,2}'|qu')(\w{2,})$")
_DIGITS = "0123456789"
_LINE_ENDS = "\n\v\f\r\x1c\x1d\x1e\x85\u2028\u2029"
_MARKS = ("Mn", "Me")
_KANA_LENGTH = "\u30fc\uff70\u301c"
_SAME_LETTER = str.maketrans(
    dict(TYPED_ALIKE)
    | {
        "đ": "d",
        "ł": "l",
        "ø": "o",
        "\N{ARABIC LETTER TEH MARBUTA}": "\N{ARABIC LETTER HEH}",
        "\N{ARABIC TATWEEL}": None,
        "'": None,
    }
    | dict(zip("ŧтτмкнвտ", "tttmkhbs", strict=True))  # their capitals look like Latin ones
    | dict(zip("ᴀʙᴄᴅᴇꜰɢʜɪᴊᴋʟᴍɴᴏᴘʀꜱᴛᴜᴠᴡʏᴢ", "abcdefghijklmnoprstuvwyz", strict=True))
)
"""Letters that no accent removal simplifies, with the letters that people type instead."""

_FRAMED = {first + i: chr(ord("a") + i) for first in (0x1F150, 0x1F170, 0x1F1E6) for i in range(26)}
"""Letters in black circles and squares and of flags, for which Unicode names no plain form."""


@dataclass(frozen=True, slots=True)
class SpelledWord:
    """A word of a text."""

    exact: str
    """The word in lower case, with its accents."""
    bare: str
    """The folded form that all ways to write the word share."""
    breaks: bool
    """Whether punctuation stands before the word, so that it begins a clause."""


def readings(text: str) -> Iterator[tuple[SpelledWord, ...]]:
    """The words of a text, once for each way to read it.

    Hidden characters and punctuation may stand inside a word or between two words ("s.t.o.p",
    "don't.stop").
    """
    text = text.translate(_FRAMED)
    seen = without_hidden(text)
    yield words(seen)
    if seen != text:
        yield words(without_hidden(text, " "))
    if (uncut := _uncut(seen)) != seen:
        yield words(uncut)


def spelled_out(found: tuple[SpelledWord, ...]) -> Iterator[str]:
    """The bare text that each row of single letters spells."""
    for alone, row in groupby(found, lambda word: len(word.exact) == 1 and word.exact.isalpha()):
        if alone:
            yield bare("".join(word.exact for word in row))


@lru_cache(maxsize=64)
def words(text: str) -> tuple[SpelledWord, ...]:
    """The words, in order, of a text that has no hidden characters.

    In a script without spaces each character is a word.
    """
    found: list[SpelledWord] = []
    breaks, letters = True, ""

    def end() -> None:
        nonlocal breaks, letters
        for part in _parts(letters):
            found.append(SpelledWord(part, bare(part), breaks))
            breaks = False
        letters = ""

    folded = one_form(text).casefold()
    for i, character in enumerate(folded):
        if character in _KANA_LENGTH:
            continue
        if _stands_alone(character):
            end()
            kana = _hiragana(character)
            if not (found and found[-1].exact == kana and not breaks):  # said long
                found.append(SpelledWord(kana, _skeleton(kana), breaks))
            breaks = False
        elif not letters and unicodedata.category(character) in _MARKS:
            continue  # a mark without a letter, or on a character that is a word by itself
        elif _in_word(character):
            letters += character
        else:
            end()
            breaks = breaks or not _joins(folded, i)
    end()
    return tuple(found)


@lru_cache(maxsize=4096)
def bare(word: str) -> str:
    """Fold a word: no accents, vowel marks, outer digits or repeated letters; look-alikes equal."""
    letters = word.strip(_DIGITS) or word
    letters = "".join(
        c for c in unicodedata.normalize("NFD", letters) if unicodedata.category(c) not in _MARKS
    )
    letters = _skeleton(letters.translate(_SAME_LETTER)).casefold()
    return re.sub(r"(\D)\1+", r"\1", letters)


def _parts(letters: str) -> Iterator[str]:
    """The word, or the two words that an elision joins: "t'arrête" is "t'" and "arrête"."""
    letters = letters.strip("'")
    if letters:
        elided = _ELISION.match(letters)
        yield from elided.groups() if elided else (letters,)


@lru_cache(maxsize=64)
def _uncut(text: str) -> str:
    """Remove the punctuation inside words."""
    around = zip(" " + text, text, text[1:] + " ", strict=False)
    return "".join(c for before, c, after in around if not _cuts(before, c, after))


def _cuts(before: str, character: str, after: str) -> bool:
    return not (
        _in_word(character) or character.isspace() or before.isspace() or after.isspace()
    ) and not _stands_alone(character)


@lru_cache(maxsize=4096)
def _in_word(character: str) -> bool:
    """True for letters, digits and their marks (the vowel signs of Hindi, for example)."""
    return character == "'" or unicodedata.category(character)[0] in "LMN"


def _joins(text: str, i: int) -> bool:
    """True if the character separates words but not clauses.

    White space does, except the end of a line; so do hyphens within words.
    """
    character = text[i]
    if character in _HYPHENS:
        around = text[max(0, i - 1) : i] + text[i + 1 : i + 2]
        return len(around) == 2 and not any(c.isspace() for c in around)
    return character.isspace() and character not in _LINE_ENDS


@lru_cache(maxsize=4096)
def _stands_alone(character: str) -> bool:
    """True for a character that is a word: Chinese characters, kana, and pictures that stop."""
    code = ord(character)
    return (
        0x3041 <= code <= 0x30FA
        or 0x3400 <= code <= 0x9FFF
        or 0x20000 <= code <= 0x3FFFF
        or character in STOP_SIGNS
    )


def _hiragana(character: str) -> str:
    code = ord(character)
    return chr(code - 0x60) if 0x30A1 <= code <= 0x30F6 else character


@lru_cache(maxsize=4096)
def _skeleton(letters: str) -> str:
    return "".join(_prototype(c) for c in letters)


@lru_cache(maxsize=1024)
def _prototype(character: str) -> str:
    """The letter that this one looks like in Unicode's table of confusables; itself if none."""
    similar = [one["c"] for one in confusables_data.get(character, ()) if len(one["c"]) == 1]
    if len(similar) != 1:
        return character  # a prototype itself, or similar to nothing
    (other,) = similar
    return min(character, other) if len(confusables_data.get(other, ())) == 1 else str(other)
