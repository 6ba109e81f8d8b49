"""Disfluencies: what people say while they look for words, and what no recogniser needs.

Hesitations ("uh"), words that only open a sentence ("and then"), the beginning of a word that is
said whole after it ("t turn") and words that are said twice ("go straight go straight") are taken
out before a sentence is understood. Stop words are found before that, in the words as they were.
"""

import re
from functools import lru_cache

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.text.spelling import key

_LONGEST_REPEAT = 3
_LONGER = re.compile(r"(.)\1+")
_DRAWN_OUT = re.compile(r"([b-df-hj-ln-tvw])\1{2,}[.,]?", re.IGNORECASE)
"""A consonant, held: "fff". Letters of the axes are none of these, nor is the metre's."""
_AXES = frozenset("xyz")
_CONSONANTS = re.compile(r"[b-df-hj-np-tv-xz]{1,3}")
"""Letters of a word that was broken off; with a vowel they may be a word."""


@lru_cache(maxsize=2048)
def fluent(text: str, language: str) -> str:
    """The sentence without its disfluencies; as it is if nothing else was said."""
    hearing = phrasebook(language).hearing
    if not hearing.spaced:
        return _unspaced(text, hearing.hesitations, hearing.openers)
    words = [(one, _LONGER.sub(r"\1", key(one))) for one in text.split()]
    hesitations = {_LONGER.sub(r"\1", key(one)) for one in hearing.hesitations}
    words = [one for one in words if one[1] not in hesitations and not _DRAWN_OUT.fullmatch(one[0])]
    openers = [[_LONGER.sub(r"\1", part) for part in key(one).split()] for one in hearing.openers]
    while size := max((len(o) for o in openers if [w for _, w in words[: len(o)]] == o), default=0):
        words = words[size:]
    words = [
        one for at, one in enumerate(words) if not _is_begun(one[1], [w for _, w in words[at:]])
    ]
    kept = [one for at, one in enumerate(words) if not _is_said_again(words, at)]
    return " ".join(word for word, _ in kept) or text


def _unspaced(text: str, hesitations: tuple[str, ...], openers: tuple[str, ...]) -> str:
    said = text
    for one in hesitations:
        said = said.replace(one, "")
    said = said.lstrip(_MARKS)
    for one in openers:
        said = said.removeprefix(one).lstrip(_MARKS)
    return said or text


_MARKS = " \u3001\u3002,."


def _is_begun(word: str, rest: list[str]) -> bool:
    """True if the word is the beginning of the next one, and no word."""
    after = rest[1] if len(rest) > 1 else ""
    broken = word not in _AXES and _CONSONANTS.fullmatch(word)
    return bool(broken) and after.startswith(word) and len(after) > len(word)


def _is_said_again(words: list[tuple[str, str]], at: int) -> bool:
    """True if this word belongs to words that are said again right behind them."""
    plain = [word for _, word in words]
    for size in range(1, _LONGEST_REPEAT + 1):
        for start in range(max(0, at - size + 1), at + 1):
            once, again = plain[start : start + size], plain[start + size : start + 2 * size]
            if once == again and not any(character.isdigit() for character in "".join(once)):
                return True
    return False
