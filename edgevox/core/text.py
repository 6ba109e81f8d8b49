"""Text from outside, made safe to handle: bounded, on one line, without hidden characters."""

import re
import unicodedata

MAX_CHARACTERS = 2000
"""The longest utterance that is taken."""

_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"  # what a decoder leaves where bytes were not UTF-8
_TERMINAL_CODE = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]")
_APOSTROPHES = str.maketrans(
    dict.fromkeys(
        "`\N{ACUTE ACCENT}\N{LEFT SINGLE QUOTATION MARK}\N{RIGHT SINGLE QUOTATION MARK}"
        "\N{MODIFIER LETTER APOSTROPHE}\N{MODIFIER LETTER PRIME}\N{PRIME}\N{FULLWIDTH APOSTROPHE}",
        "'",
    )
)
_IGNORABLE = re.compile(
    "[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u3164\ufe00-\ufe0f\uffa0\U000e0000-\U000e0fff]"
)
"""What Unicode calls default-ignorable, beside the format characters."""


_JOINED = re.compile("(?<=\\d)(?=[\u00bc-\u00be\u2150-\u215f\u2189])")
_RAISED = re.compile("(?<=\\d)(?=[\u00b2\u00b3\u00b9\u2070-\u2079\u2080-\u2089])")
"""Fractions and powers right behind a number, which would become digits of it."""


def clean(text: str) -> str:
    """One line of visible characters, each in one form; looks at a bounded part only."""
    bounded = text[: 2 * MAX_CHARACTERS].replace(_REPLACEMENT, " ")
    return " ".join(one_form(without_hidden(bounded)).split())


def one_form(text: str) -> str:
    """Letters and their accents as one character, wide ones as narrow ones, one apostrophe.

    "2\u00bd" becomes 2 and a fraction, and a power stays one: neither is a number of more digits.
    """
    if text.isascii():  # in one form already, but for an accent that stands for an apostrophe
        return text.replace("`", "'")
    text = _RAISED.sub("^", _JOINED.sub(" ", text.translate(_APOSTROPHES)))
    return unicodedata.normalize("NFKC", text)


def without_hidden(text: str, instead: str = "") -> str:
    """The same text with something else for control, format and default-ignorable characters.

    White space of any kind stays; lone surrogates and private characters go too.
    """
    text = _IGNORABLE.sub(instead, _TERMINAL_CODE.sub(instead, text))
    if text.isprintable():
        return text
    return "".join(instead if _is_hidden(c) else c for c in text)


def _is_hidden(character: str) -> bool:
    return unicodedata.category(character)[0] == "C" and not character.isspace()
