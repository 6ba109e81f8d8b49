"""Functions that make text from outside safe: bounded, on one line, without hidden characters.

Text from outside may reach a terminal or a log only through `one_line` or `printable`.
"""

import re
import unicodedata

MAX_CHARACTERS = 2000
"""Length of the longest accepted utterance."""

_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"  # what a decoder leaves where bytes were not UTF-8
_TERMINAL_CODE = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]")
_COLOUR = re.compile(r"(\x1b\[[0-9;]*m)")
_JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"
"""Invisible joiners with which words of some languages are written."""
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
"""Characters that Unicode calls default-ignorable, without the format characters."""


_JOINED = re.compile("(?<=\\d)(?=[\u00bc-\u00be\u2150-\u215f\u2189])")
_RAISED = re.compile("(?<=\\d)(?=[\u00b2\u00b3\u00b9\u2070-\u2079\u2080-\u2089])")
"""Positions of fractions and powers right after a number, which would become its digits."""


def clean(text: str) -> str:
    """One line of visible characters, each in one form; looks at a bounded part only."""
    bounded = text[: 2 * MAX_CHARACTERS].replace(_REPLACEMENT, " ")
    return " ".join(one_form(without_hidden(bounded)).split())


def one_form(text: str) -> str:
    """Letters and their accents as one character, wide ones as narrow ones, one apostrophe.

    "2\u00bd" becomes 2 and a fraction, and a power stays one: neither is a number of more digits.
    """
    if text.isascii():  # in one form already, except a grave accent for an apostrophe
        return text.replace("`", "'")
    text = _RAISED.sub("^", _JOINED.sub(" ", text.translate(_APOSTROPHES)))
    return unicodedata.normalize("NFKC", text)


def without_hidden(text: str, instead: str = "") -> str:
    """The text with `instead` for control, format, private and default-ignorable characters.

    Lone surrogates are replaced as well; white space of any kind stays.
    """
    text = _IGNORABLE.sub(instead, _TERMINAL_CODE.sub(instead, text))
    if text.isprintable():
        return text
    return "".join(instead if _is_hidden(c) else c for c in text)


def one_line(text: str) -> str:
    """The text with Python's escapes for characters that break lines, steer terminals or hide."""
    if text.isprintable():
        return text
    return "".join(map(_coded, text))


def printable(text: str) -> str:
    """The text as `one_line` makes it, but with its line ends."""
    return "\n".join(map(one_line, text.split("\n")))


def printable_in_colour(line: str) -> str:
    """The line as `one_line` makes it, but with its colours."""
    return "".join(one if _COLOUR.fullmatch(one) else one_line(one) for one in _COLOUR.split(line))


def _coded(character: str) -> str:
    if character.isprintable() or character in _JOINERS or unicodedata.category(character) == "Zs":
        return character
    return repr(character)[1:-1]


def _is_hidden(character: str) -> bool:
    return unicodedata.category(character)[0] == "C" and not character.isspace()
