"""Decides whether two names are the same: for teaching, the policy, files and calls of skills.

"Bed_Room", "the bedroom" and "bédroom" are one name. So that no language opens a door that another
one shuts, the articles and the plurals of all languages count, whichever is spoken.
"""

import unicodedata
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import islice, product
from typing import Any

from edgevox.agent.text.alike import most_alike
from edgevox.agent.text.spelling import key
from edgevox.core.files.text import without_hidden
from edgevox.core.languages import EVERY_LANGUAGE

_SHORTEST = 3
"""Least number of letters that stay when an ending or a letter is removed."""
_SHORTEST_SLIP, _NEAR = 5, 0.85
"""Least length of a name, and least similarity of another, for a slip."""
_MOST_SINGULARS = 256
_DASHES = str.maketrans(dict.fromkeys("-_/.\N{EN DASH}\N{EM DASH}\N{MINUS SIGN}", " "))
_LOOKALIKES = str.maketrans(
    {
        **dict(zip("аеорсухкмтнвіјѕԁӏ", "aeopcyxkmthbijsdl", strict=True)),
        **dict(zip("αορνικτυχ", "aopviktux", strict=True)),
        **dict(zip("øłđħı", "oldhi", strict=True)),
        **dict(zip("ʙᴄᴅᴇɢʜɪᴊᴋʟᴍɴᴏᴘʀᴛᴜᴠᴡʏᴢ", "bcdeghijklmnoprtuvwyz", strict=True)),
        **{chr(one): chr(one + 0x60) for one in range(0x3041, 0x3097)},  # hiragana as katakana
        **{chr(one): "" for one in (*range(0x64B, 0x656), 0x670)},  # short vowels of Arabic
        "œ": "oe",
        "æ": "ae",
        "ـ": "",
    }
)
"""Letters that are read as others, whose stroke no decomposition takes away, or which people leave
out."""


@lru_cache(maxsize=8192)
def name_form(name: str) -> str:
    """The one form of a name: all that are the same name have it.

    It ignores case, accents, separators, hidden characters, letters that look alike, and articles
    and possessives around the name. It is for comparing, not for people.
    """
    return "".join(_bare_words(name))


def names_meant(name: str, known: Mapping[str, str]) -> tuple[str, ...]:
    """The words that a name stands for; `known` maps names to words.

    Of the same form first; where there is none, the singular of it or its plural, or what begins
    as an article does: "do-ck".
    """
    form = name_form(name)
    if not form:
        return ()
    forms = [(name_form(one), one, word) for one, word in known.items()]
    if same := [word for one, _, word in forms if one == form]:
        return tuple(dict.fromkeys(same))
    others = _other_forms(name)
    near = [word for one, said, word in forms if one in others or form in _other_forms(said)]
    return tuple(dict.fromkeys(near))


def names_near(name: str, known: Mapping[str, str]) -> tuple[str, ...]:
    """The words for which a name may be a writing or hearing error: "kichen".

    A name with a digit in it is none: "dock 2" is not "dock".
    """
    form = name_form(name)
    if len(form) < _SHORTEST_SLIP or any(one.isdigit() for one in form):
        return ()
    forms = {name_form(one): word for one, word in known.items()}
    return tuple(forms[one] for one in most_alike(form, forms, least=_NEAR))


def is_same_name(one: str, other: str) -> bool:
    """True if two names are the same, or one is the plural of the other."""
    return bool(names_meant(one, {other: other}))


@lru_cache(maxsize=8192)
def _bare_words(name: str) -> tuple[str, ...]:
    """The words of a name as they are compared, without what stands around them."""
    words = _without_after(_without_before(_words(name)))
    if words:
        words[0] = _without_joined(words[0])
    return tuple(map(_compared, words))


def _words(name: str) -> list[str]:
    spelled = key(without_hidden(name).translate(_DASHES))
    return [word for one in spelled.split() if (word := _letters(one))]


def _compared(word: str) -> str:
    return word.replace("'", "").translate(_LOOKALIKES)


def _letters(word: str) -> str:
    """Without signs; an apostrophe stays where an article ends with it."""
    kept = (one for one in word if unicodedata.category(one)[0] in "LMN" or one == "'")
    text = "".join(kept)
    return text if text in _before() else text.replace("'", "")


def _without_before(words: list[str]) -> list[str]:
    while len(words) > 1 and words[0] in _before():
        rest = words[1:]
        if len(words[0]) == 1 and sum(map(len, rest)) < _SHORTEST:
            break  # "A 2" is no article and a number
        words = rest
    return words


def _without_after(words: list[str]) -> list[str]:
    again = True
    while again:
        again = False
        for one in _after():
            if len(words) > len(one) and tuple(words[-len(one) :]) == one:
                words, again = words[: -len(one)], True
    return words


def _without_joined(word: str) -> str:
    for start in _joined():
        if word.startswith(start) and len(word) - len(start) >= 2:
            return word[len(start) :]
    return word


@lru_cache(maxsize=8192)
def _other_forms(name: str) -> frozenset[str]:
    """The forms of what a name may be the plural of, and its own with all that stands around it."""
    words = _bare_words(name)
    whole = "".join(words)
    readings = product(*([word, *_singular(word)] for word in words[:3]))
    rest = "".join(words[3:])
    found = {"".join(one) + rest for one in islice(readings, _MOST_SINGULARS)}
    found.update(_singular(whole))  # "kitchen's" is in two words
    found.add("".join(map(_compared, _words(name))))
    if len(words) == 2 and words[0] == words[1]:  # "dapur-dapur" are several kitchens
        found.add(words[0])
    return frozenset(found - {whole})


def _singular(word: str) -> Iterator[str]:
    for ending, instead in _plurals():
        stem = word.removesuffix(ending)
        if stem != word and len(stem) >= (_SHORTEST if word[0] < "\u3040" else 1):
            yield stem + instead


def _table(name: str) -> Iterator[Any]:
    for entries in EVERY_LANGUAGE["names"][name].values():
        yield from entries


@lru_cache
def _before() -> frozenset[str]:
    return frozenset(_table("before"))


@lru_cache
def _after() -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(one.split()) for one in _table("after"))


@lru_cache
def _joined() -> tuple[str, ...]:
    """The longest first."""
    return tuple(sorted(_table("joined"), key=len, reverse=True))


@lru_cache
def _plurals() -> tuple[tuple[str, str], ...]:
    return tuple((_ending(end), _ending(to)) for end, to in _table("plurals"))


def _ending(text: str) -> str:
    return key(text).translate(_LOOKALIKES)
