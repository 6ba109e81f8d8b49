"""One spelling of what a recogniser reads and what it is compared with."""

import re
import unicodedata

NUMBER = r"-?\d+(?:\.\d+)?"
"""The pattern of a number in digits."""

_KANA_VOICING = 8
"""The combining class of the marks that make another Japanese letter, not an accented one."""
_ONE_FORM = str.maketrans(
    {
        "\N{RIGHT SINGLE QUOTATION MARK}": "'",
        "\N{MODIFIER LETTER APOSTROPHE}": "'",
        "\N{LATIN SMALL LETTER DOTLESS I}": "i",
        "\N{ARABIC LETTER ALEF MAKSURA}": "\N{ARABIC LETTER YEH}",
        "\N{DEVANAGARI SIGN CANDRABINDU}": "\N{DEVANAGARI SIGN ANUSVARA}",
    }
)
_APOSTROPHE = re.compile(r"(?<=\w)' ?(?=\w)")
_HYPHEN = re.compile(r"(?<=[^\W\d])[-\N{NON-BREAKING HYPHEN}](?=[^\W\d])")
_PUNCTUATION = re.compile(
    r"[(){}\[\]<>|,;:=?!\"\u00a1\u00bf\u00ab\u00bb\u201c-\u201f\u2026\u060c\u061b\u061f\u0964"
    r"\u3001\u3002\u300c-\u300f\u30fb]+|\.(?!\d)"
)


def composed(text: str) -> str:
    """Letters and their accents as one character, wide digits and marks as narrow ones."""
    return unicodedata.normalize("NFKC", text)


def separated(text: str) -> str:
    """Words that an apostrophe or a hyphen joins stand apart: "va-t'en" becomes "va t' en"."""
    return _HYPHEN.sub(" ", _APOSTROPHE.sub("' ", text.translate(_ONE_FORM)))


def unpunctuated(text: str) -> str:
    """No punctuation but the decimal point, and single spaces."""
    return " ".join(_PUNCTUATION.sub(" ", text).split())


def folded(text: str) -> str:
    """Letters without their accents, in the same number of characters.

    People who type leave accents out, and transcripts differ in them.
    """
    return "".join(_bare(character) for character in text)


def key(text: str) -> str:
    """What two spellings of one word have in common."""
    plain = folded(separated(composed(text.replace("_", " "))))
    return unpunctuated(plain.casefold())


def _bare(character: str) -> str:
    parts = unicodedata.normalize("NFD", character)
    if any(unicodedata.combining(mark) in (0, _KANA_VOICING) for mark in parts[1:]):
        return character
    return parts[0]
