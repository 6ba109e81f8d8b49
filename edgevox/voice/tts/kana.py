"""Japanese script converted to kana: espeak-ng says "Chinese letter" for other characters."""

from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any

PACKAGE = "pykakasi"
_PARTICLES = {"は": "わ", "へ": "え", "を": "お"}  # as particles they sound otherwise


def kana(text: str) -> str:
    """The text in hiragana, a space between words. Unchanged without the package pykakasi."""
    if find_spec(PACKAGE) is None:
        return text
    return " ".join(_spoken(word["orig"], word["hira"]) for word in _reader().convert(text))


def _spoken(written: str, hiragana: str) -> str:
    if written in _PARTICLES:
        return _PARTICLES[written]
    if written.endswith("は") and len(written) > 1 and not _is_kana(written):
        return hiragana[:-1] + "わ"
    return hiragana


def _is_kana(text: str) -> bool:
    return all("ぁ" <= character <= "ん" for character in text)


@cache
def _reader() -> Any:
    """Load the reader; its dictionary takes half a second."""
    return import_module(PACKAGE).kakasi()
