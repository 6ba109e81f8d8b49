"""Disfluencies: what people say while they look for words, and what no recogniser needs.

Hesitations ("uh"), words that only open a sentence ("and then"), the beginning of a word that is
said whole after it ("t turn") and words that are said twice ("go straight go straight") are taken
out before a sentence is understood. Stop words are found before that, in the words as they were.
"""

import itertools
import re
from functools import cache, lru_cache

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.text.spelling import key

_LONGEST_REPEAT = 3
_MARKS = " \u3001\u3002,."
_LONGER = re.compile(r"(.)\1+")
_DRAWN_OUT = re.compile(r"([b-df-hj-ln-tvw])\1{2,}[.,]?", re.IGNORECASE)
"""A consonant, held: "fff". Letters of the axes are none of these, nor is the metre's."""
_HUM = re.compile(r"[hmnu]+")
"""A hum, as speech recognition spells it: "M-H-M", "Uhm-hum"."""
_BROKEN_OFF = re.compile(r"(?![xyz]$)[b-df-hj-np-tv-xz]{1,3}")
"""The beginning of a word that is no word: with a vowel it may be one, and so may an axis."""


@lru_cache(maxsize=2048)
def fluent(text: str, language: str) -> str:
    """The sentence without its disfluencies; as it is if nothing else was said."""
    if not phrasebook(language).hearing.spaced:
        return _unspaced(text, language) or text
    hesitations, openers = _known(language)
    said = [one for one in text.split() if not _DRAWN_OUT.fullmatch(one)]
    said = [one for one in said if _plain(one) not in hesitations]
    plain = [_plain(one) for one in said]
    start = 0
    while size := max((len(o) for o in openers if plain[start : start + len(o)] == o), default=0):
        start += size
    said, plain = _without_begun(said[start:], plain[start:])
    again = _said_again(plain)
    return " ".join(one for at, one in enumerate(said) if at not in again) or text


def is_back_channel(text: str, language: str) -> bool:
    """True if these words only tell that somebody listens; also for no words: laughter, a cough."""
    said, known = _pieces(text, language), _back_channels(language)
    said = [one for one in said if not _HUM.fullmatch(one)]
    while said:
        size = max((len(one) for one in known if said[: len(one)] == one), default=0)
        if not size:
            return False
        said = said[size:]
    return True


@cache
def _back_channels(language: str) -> list[list[str]]:
    hearing = phrasebook(language).hearing
    return [_pieces(one, language) for one in (*hearing.hesitations, *hearing.back_channels)]


def _pieces(text: str, language: str) -> list[str]:
    """The words as `_plain` has them; the characters, in a script without spaces."""
    words = key(text).split()
    spaced = phrasebook(language).hearing.spaced
    return [_plain(word) for word in words] if spaced else list("".join(words))


def _plain(word: str) -> str:
    """The word with each lengthened sound once: "uhhh" is "uh"."""
    return _LONGER.sub(r"\1", key(word))


@cache
def _known(language: str) -> tuple[frozenset[str], list[list[str]]]:
    """The hesitations and the words of the openers of a language, as `_plain` has them."""
    hearing = phrasebook(language).hearing
    openers = [[_plain(word) for word in one.split()] for one in hearing.openers]
    return frozenset(map(_plain, hearing.hesitations)), openers


def _unspaced(text: str, language: str) -> str:
    hearing = phrasebook(language).hearing
    for one in hearing.hesitations:
        text = text.replace(one, "")
    text = text.lstrip(_MARKS)
    for one in hearing.openers:
        text = text.removeprefix(one).lstrip(_MARKS)
    return text


def _without_begun(said: list[str], plain: list[str]) -> tuple[list[str], list[str]]:
    """The words without those that are only the beginning of the next one."""
    kept = [
        at
        for at, (word, after) in enumerate(itertools.pairwise([*plain, ""]))
        if not (_BROKEN_OFF.fullmatch(word) and after.startswith(word) and after != word)
    ]
    return [said[at] for at in kept], [plain[at] for at in kept]


def _said_again(plain: list[str]) -> set[int]:
    """Indices of words that are said again right behind them, one to a few at a time."""
    again: set[int] = set()
    for size in range(1, _LONGEST_REPEAT + 1):
        for start in range(len(plain) - 2 * size + 1):
            once = plain[start : start + size]
            same = once == plain[start + size : start + 2 * size]
            if same and not any(map(str.isdigit, "".join(once))):
                again.update(range(start, start + size))
    return again
