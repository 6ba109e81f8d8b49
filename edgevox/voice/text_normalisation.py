"""Text made fit to be spoken: no markup, no addresses, no pictures, numbers that read well."""

import re
import unicodedata
from collections.abc import Mapping

from edgevox.core.languages import LANGUAGES

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
