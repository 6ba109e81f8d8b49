"""A long sentence in phrases, so that its first words are heard while the rest is synthesised."""

import re

_CLAUSE = re.compile(r"(?<=[,;:—–،؛])\s+|(?<=[、，；：])")  # noqa: RUF001
_LEAST_CHARS = 12
_LONGEST_CHARS = 240
_WIDE = "\N{CJK RADICAL REPEAT}"
"""From here on a character is a syllable or a word, and counts as three."""


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
