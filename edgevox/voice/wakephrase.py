"""Taking the wake word out of what was understood: speech to text spells it in its own ways."""

import re
from collections.abc import Iterable
from difflib import SequenceMatcher

ALIKE = 0.6
"""How alike words and phrase must be, 0 to 1: "Hey, Darvie's" is meant for "hey jarvis"."""
MAX_WORDS_BEFORE = 4

_WORD = re.compile(r"[\w']+")


def without_phrase(text: str, phrase: str) -> str:
    """What follows the phrase, if it is near the beginning; else the text as it is."""
    words = list(_WORD.finditer(text))
    wanted = _joined(_WORD.findall(phrase))
    best, end = 0.0, 0
    for first in range(min(len(words), MAX_WORDS_BEFORE + 1)):
        for count in range(1, len(_WORD.findall(phrase)) + 2):
            these = words[first : first + count]
            likeness = _likeness(_joined(match.group() for match in these), wanted)
            if len(these) == count and likeness > best:
                best, end = likeness, these[-1].end()
    return text[end:].lstrip(" ,.;:!?-") if best >= ALIKE else text


def _likeness(words: str, phrase: str) -> float:
    return SequenceMatcher(None, words, phrase, autojunk=False).ratio()


def _joined(words: Iterable[str]) -> str:
    return "".join(words).casefold()
