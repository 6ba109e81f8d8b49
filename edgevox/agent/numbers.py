"""Numbers as people say them, written as digits: small models get them wrong."""

import re
from functools import lru_cache

from text_to_num import alpha2digit

from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.phrase_numbers import Numbers
from edgevox.agent.spelling import NUMBER

_GLUED = re.compile(r"\s*(?<![^\W\d])([xyz])\s*(?=-?\d)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])(\d+),(\d+)(?![\d.,]*\d)")


@lru_cache(maxsize=2048)
def digits(text: str, language: str = "en") -> str:
    """The same text with its number words as digits: "minus two and a half" becomes "-2.5".

    Fractions become decimals with a point, centimetres become metres, and the name of an axis gets
    off its number ("x2.5": so whisper writes coordinates). Kept, for all who read a sentence ask,
    and whoever learns a language's words asks for the same ones again.
    """
    known = phrasebook(language).numbers
    if known.library:
        text = str(alpha2digit(text, known.library, 0))
    text = known.words.as_digits(text) if known.words else text
    text = _GLUED.sub(r" \1 ", text).strip()
    if known.decimal_comma:
        text = _DECIMAL_COMMA.sub(r"\1.\2", text)
    for pattern, replacement in known.rules:
        text = pattern.sub(replacement, text)
    return _in_metres(text, known)


def _in_metres(text: str, known: Numbers) -> str:
    if not known.centimetres:
        return text
    pattern = rf"({NUMBER})\s*(?:{known.centimetres})(?!\w)"
    if known.units:
        pattern = rf"({NUMBER})\s*(?:{known.centimetres})"
    return re.sub(
        pattern,
        lambda match: f"{float(match[1]) / 100:g} {known.metres}",
        text,
        flags=re.IGNORECASE,
    )
