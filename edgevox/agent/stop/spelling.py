"""A text as words in which a stop word can be found, however it was written.

People shout, type without accents, lengthen letters and spell words out; attackers hide characters
and use letters that look alike. All of that is folded here, for stop words only.
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
from edgevox.core.stop_words import STOP_SIGNS

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
"""Letters that have no accent to take away, and are typed as others all the same."""

_FRAMED = {first + i: chr(ord("a") + i) for first in (0x1F150, 0x1F170, 0x1F1E6) for i in range(26)}
"""Letters in black circles and squares and of flags, which have no other form in Unicode."""


@dataclass(frozen=True, slots=True)
class SpelledWord:
    """A word of a text.

    `exact` is lower case with its accents; `bare` is what it has in common with the other ways to
    write it. `breaks` tells whether punctuation stands before it: then it begins a clause.
    """

    exact: str
    bare: str
    breaks: bool


def readings(text: str) -> Iterator[tuple[SpelledWord, ...]]:
    """The words of a text, in each of the ways in which it can be read.

    Hidden characters may stand in a word or between two, and so may punctuation ("s.t.o.p",
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
    """What letters that stand alone spell, bare: one text for each row of them."""
    for alone, row in groupby(found, lambda word: len(word.exact) == 1 and word.exact.isalpha()):
        if alone:
            yield bare("".join(word.exact for word in row))


@lru_cache(maxsize=64)
def words(text: str) -> tuple[SpelledWord, ...]:
    """The words of a text without hidden characters, in their order.

    A script without spaces has a word for each character.
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
            continue  # on nothing, or on a character that is a word
        elif _in_word(character):
            letters += character
        else:
            end()
            breaks = breaks or not _joins(folded, i)
    end()
    return tuple(found)


@lru_cache(maxsize=4096)
def bare(word: str) -> str:
    """Without accents, vowel marks, digits around it and repeated letters; look-alikes as one."""
    letters = word.strip(_DIGITS) or word
    letters = "".join(
        c for c in unicodedata.normalize("NFD", letters) if unicodedata.category(c) not in _MARKS
    )
    letters = _skeleton(letters.translate(_SAME_LETTER)).casefold()
    return re.sub(r"(\D)\1+", r"\1", letters)


def _parts(letters: str) -> Iterator[str]:
    """A word, or the two that an elision joins: "t'arrête" is "t'" and "arrête"."""
    letters = letters.strip("'")
    if letters:
        elided = _ELISION.match(letters)
        yield from elided.groups() if elided else (letters,)


@lru_cache(maxsize=64)
def _uncut(text: str) -> str:
    """Without the punctuation that stands within words."""
    around = zip(" " + text, text, text[1:] + " ", strict=False)
    return "".join(c for before, c, after in around if not _cuts(before, c, after))


def _cuts(before: str, character: str, after: str) -> bool:
    return not (
        _in_word(character) or character.isspace() or before.isspace() or after.isspace()
    ) and not _stands_alone(character)


@lru_cache(maxsize=4096)
def _in_word(character: str) -> bool:
    """Letters, digits and the marks that belong to them (the vowel signs of Hindi, say)."""
    return character == "'" or unicodedata.category(character)[0] in "LMN"


def _joins(text: str, i: int) -> bool:
    """White space but the end of a line, and hyphens within words, part words, not clauses."""
    character = text[i]
    if character in _HYPHENS:
        around = text[max(0, i - 1) : i] + text[i + 1 : i + 2]
        return len(around) == 2 and not any(c.isspace() for c in around)
    return character.isspace() and character not in _LINE_ENDS


@lru_cache(maxsize=4096)
def _stands_alone(character: str) -> bool:
    """Chinese characters, kana, and pictures that stop."""
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
    """The letter that this one looks like, by Unicode's table of confusables; itself if none."""
    similar = [one["c"] for one in confusables_data.get(character, ()) if len(one["c"]) == 1]
    if len(similar) != 1:
        return character  # it is a prototype, or like nothing
    (other,) = similar
    return min(character, other) if len(confusables_data.get(other, ())) == 1 else str(other)
