"""Spelling in one form, for the text of a recogniser and for the words to compare it with.

It begins with the one form of each character that `core.text` gives any text from outside.
"""

import itertools
import re
import unicodedata
from collections.abc import Mapping
from functools import lru_cache

from edgevox.core.files.text import one_form

NUMBER = r"-?\d+(?:\.\d+)?"
"""The pattern of a number in digits."""

_KANA_VOICING = 8
"""The combining class of the marks that make another Japanese letter, not an accented one."""
TYPED_ALIKE: Mapping[str, str] = {
    "\N{LATIN SMALL LETTER DOTLESS I}": "i",
    "\N{ARABIC LETTER ALEF MAKSURA}": "\N{ARABIC LETTER YEH}",
    "\N{DEVANAGARI SIGN CANDRABINDU}": "\N{DEVANAGARI SIGN ANUSVARA}",
}
"""Letters that have no accent to take away, and are typed for each other all the same."""
_TYPED_ALIKE = str.maketrans(dict(TYPED_ALIKE))
ENDING = 2
"""Number of letters that an ending may add to a name."""
_SHORTEST_STEM = 4
_UMLAUT = re.compile("([aou])e")
_APOSTROPHE = re.compile(r"(?<=\w)' ?(?=\w)")
_LONG_HYPHEN = "\N{NON-BREAKING HYPHEN}"
_HYPHEN = re.compile(rf"(?<=\w)[-{_LONG_HYPHEN}](?=[^\W\d])")
_PUNCTUATION = re.compile(
    r"[(){}\[\]<>|,;:=?!\"\u00a1\u00bf\u00ab\u00bb\u201c-\u201f\u2026\u060c\u061b\u061f\u0964"
    r"\u3001\u3002\u300c-\u300f\u30fb]+|\.(?!\d)"
)


def separated(text: str) -> str:
    """Words that an apostrophe or a hyphen joins stand apart: "va-t'en" becomes "va t' en".

    Of a text in one form.
    """
    if not text.isascii():
        text = text.translate(_TYPED_ALIKE)
    if "'" in text:
        text = _APOSTROPHE.sub("' ", text)
    return _HYPHEN.sub(" ", text) if "-" in text or _LONG_HYPHEN in text else text


def unpunctuated(text: str) -> str:
    """No punctuation but the decimal point, and single spaces."""
    return " ".join(_PUNCTUATION.sub(" ", text).split())


def folded(text: str) -> str:
    """Letters without their accents, in the same number of characters.

    People who type leave accents out, and transcripts differ in them.
    """
    return text if text.isascii() else "".join(map(_bare, text))


@lru_cache(maxsize=16_384)
def key(text: str) -> str:
    """The key that two spellings of one word share."""
    plain = folded(separated(one_form(text.replace("_", " "))))
    return unpunctuated(plain.casefold())


def is_same_name(said: str, name: str, *, inflected: bool) -> bool:
    """True if these keys are one name, not only similar: "living room", "livingroom", "kueche".

    Names of languages that are `inflected` may end otherwise.
    """
    whole = len(said.split()) == len(name.split())
    said, name = (_UMLAUT.sub(r"\1", one.replace(" ", "")) for one in (said, name))
    pairs = zip(said, name, strict=False)
    shared = sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], pairs))
    least = max(_SHORTEST_STEM, max(len(said), len(name)) - ENDING)
    return said == name or (inflected and whole and shared >= least)


@lru_cache(maxsize=4096)
def _bare(character: str) -> str:
    parts = unicodedata.normalize("NFD", character)
    if any(unicodedata.combining(mark) in (0, _KANA_VOICING) for mark in parts[1:]):
        return character
    return parts[0]
