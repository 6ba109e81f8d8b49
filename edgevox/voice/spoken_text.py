"""Text made fit to be spoken: no markup, no addresses, no pictures, numbers that read well.

A long sentence is split into phrases, so that its first words are heard while the rest is
synthesised.
"""

import re
import unicodedata
from collections.abc import Mapping

from edgevox.core.languages import LANGUAGES

_CLAUSE = re.compile(r"(?<=[,;:—–،؛])\s+|(?<=[、，；：])")  # noqa: RUF001
_LEAST_CHARS = 12
_LONGEST_CHARS = 240
_WIDE = "\N{CJK RADICAL REPEAT}"
"""From this character on, each is a syllable or a word, and counts as three."""


def split_phrases(sentence: str, length: int) -> list[str]:
    """The sentence in pieces of about `length` characters that end where a speaker may pause.

    A sentence that is not longer stays whole. Nothing is lost but the spaces between the pieces. A
    piece without a comma may be longer, but never beyond what any engine takes at once.
    """
    pieces = _join([part for part in _CLAUSE.split(sentence) if part.strip()], length)
    return [short for piece in pieces for short in _halves(piece.strip())]


def _join(clauses: list[str], length: int) -> list[str]:
    """Clauses put together again, as long as they stay short or would be too short alone."""
    pieces: list[str] = []
    for clause in clauses:
        if pieces and (
            _size(pieces[-1]) + _size(clause) < length
            or min(_size(pieces[-1]), _size(clause)) < _LEAST_CHARS
        ):
            pieces[-1] = _glue(pieces[-1], clause)
        else:
            pieces.append(clause)
    return pieces


def _glue(left: str, right: str) -> str:
    """Full-width marks are written without a space after them."""
    return f"{left}{right}" if left[-1] in "、，；：" else f"{left} {right}"  # noqa: RUF001


def _halves(piece: str) -> list[str]:
    """The piece, in parts at spaces if it is far too long."""
    if _size(piece) <= _LONGEST_CHARS:
        return [piece]
    most = _LONGEST_CHARS * len(piece) // _size(piece)
    at = piece.rfind(" ", 1, most)
    at = at if at > 0 else most
    return [piece[:at].strip(), *_halves(piece[at:].strip())]


def _size(text: str) -> int:
    """About how long it takes to say, in letters."""
    return sum(3 if character >= _WIDE else 1 for character in text)


_FENCE = re.compile(r"```.*?(```|$)", re.DOTALL)
_LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
_ADDRESS = re.compile(r"(?:https?://|www\.)(?:www\.)?([\w-]+(?:\.[\w-]+)+)\S*")
_BULLET = re.compile(r"(?m)^\s*(?:[-*+•]|#{1,6}|>)\s+")
_MARKUP = re.compile(r"[*`~|<>{}\\^]+|__+|(?<!\w)_+|_+(?!\w)|(?m:^\s*-{3,}\s*$)")
_JOINED = re.compile(r"(?<=\w)_(?=\w)")
_COORDINATE = re.compile(r"\b([xyz])\s*=?\s*(-?)(?=\d)", re.IGNORECASE)
_MINUS = re.compile(r"(?<![\w.])-(?=\d)")
_DASH = "-"
_JOINERS = "\N{ZERO WIDTH JOINER}\N{VARIATION SELECTOR-16}"
_PICTURES = ("So", "Sk", "Cs", "Co", "Cn")


def normalise_for_speech(text: str, language: str = "en") -> str:
    """The text as it should be spoken, on one line; empty if there is nothing to say in it."""
    text = _FENCE.sub(" ", text)
    text = _LINK.sub(r"\1", text)
    text = _ADDRESS.sub(r"\1", text)
    text = _BULLET.sub("", text)
    text = _in_words(text, LANGUAGES[language].signs)
    text = _JOINED.sub(" ", _MARKUP.sub("", text))
    text = "".join(" " if _is_picture(c) else c for c in text)
    text = re.sub(r"\s+([,.;:!?])", r"\1", " ".join(text.split()))
    return text if any(c.isalnum() for c in text) else ""


def _in_words(text: str, signs: Mapping[str, str]) -> str:
    """Signs that an engine would swallow, in words."""
    minus = f"{signs[_DASH]} "
    text = _COORDINATE.sub(lambda m: f"{m[1]} {minus if m[2] else ''}", text)
    text = _MINUS.sub(minus, text)
    for sign, words in signs.items():
        text = text if sign == _DASH else text.replace(sign, f" {words} ")
    return text


def _is_picture(character: str) -> bool:
    kind = unicodedata.category(character)
    return character in _JOINERS or kind in _PICTURES or kind == "Cc"
