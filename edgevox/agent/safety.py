"""Safety words: what halts a robot at once, whatever a model is doing."""

import re
import unicodedata
from collections.abc import Iterable

from edgevox.core.languages import LANGUAGES, Language

MAX_CHARACTERS = 2000
"""How much of an utterance is searched at each end; nobody says more before they mean stop."""

_ONE_FORM = str.maketrans(
    {
        "\N{RIGHT SINGLE QUOTATION MARK}": "'",
        "\N{LATIN SMALL LETTER DOTLESS I}": "i",
        "\N{COMBINING DOT ABOVE}": None,
    }
)
"""Typographic apostrophes; the Turkish letters i, which change their dot with their case."""


class SafetyWords:
    """Finds a stop word of one language (English ones always count too) in an utterance.

    A stop word counts wherever it stands, so that "hold it there, stop" and "go to the kitchen, no,
    stop" both halt; rather one halt too many than one too few. A negation right before it ("don't
    stop") takes it back.
    """

    def __init__(self, code: str) -> None:
        languages = [LANGUAGES[c] for c in dict.fromkeys((code, "en"))]
        self._patterns = [_pattern(language) for language in languages]
        self._alone = {normalise(word) for language in languages for word in language.stop_alone}

    def find(self, text: str) -> str | None:
        """The stop word that this utterance holds, or None."""
        for part in _ends(text):
            plain = normalise(part)
            if plain in self._alone:
                return plain
            for pattern in self._patterns:
                match = pattern.search(plain)
                if match:
                    return match.group("word")
        return None


def normalise(text: str) -> str:
    """Lower case, one form of every letter and apostrophe, no punctuation, single spaces."""
    folded = unicodedata.normalize("NFKC", text).casefold().translate(_ONE_FORM)
    return " ".join("".join(c if _in_word(c) else " " for c in folded).split())


def _in_word(character: str) -> bool:
    """Letters, digits and the marks that belong to them (the vowel signs of Hindi, say)."""
    return character == "'" or unicodedata.category(character)[0] in "LMN"


def _ends(text: str) -> Iterable[str]:
    if len(text) <= 2 * MAX_CHARACTERS:
        return (text,)
    return (text[:MAX_CHARACTERS], text[-MAX_CHARACTERS:])


def _pattern(language: Language) -> re.Pattern[str]:
    words = sorted((normalise(word) for word in language.stop_words), key=len, reverse=True)
    any_word = "|".join(re.escape(word) for word in words)
    if not language.spaced:
        return re.compile(f"(?P<word>{any_word})")
    negations = "".join(rf"(?<!\b{re.escape(normalise(n))} )" for n in language.negations)
    return re.compile(rf"{negations}(?<!\S)(?P<word>{any_word})(?!\S)")
