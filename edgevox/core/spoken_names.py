"""Names in a spoken sentence: which one it calls, and the sentence without it.

Speech to text spells names and wake words in its own ways, so words that are like a name count as
that name.
"""

import re
from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher

ALIKE = 0.75
"""The likeness, 0 to 1, from which words are a name: "Rosee" is Rosie."""
MAY_BE = 0.65
"""The likeness from which words may be a name that was misheard: "Rosy" for Rosie."""
PHRASE_ALIKE = 0.6
"""The likeness from which words are the wake word: "Hey, Darvie's" is meant for "hey jarvis"."""
MAX_WORDS_BEFORE = 4
"""Words that may stand before the wake word."""
EXACT_TO = 3
"""A name of so few letters must be heard exactly."""
ECHOED = 0.5
"""Share of the words from which on a text is what another robot says."""

_WORD = re.compile(r"[\w']+")
_CLAUSE_END = re.compile(r"[,.;:!?\u3001\u3002\uff0c\uff01\uff1f\u060c\u061f\u0964]")
_TOKEN = re.compile(r"[^\W\u3040-\u30ff\u3400-\u9fff]+|[\u3040-\u30ff\u3400-\u9fff]")
"""A word, or a character where words have no spaces between them."""


def named_in(text: str, names: Mapping[str, str], alike: float = ALIKE) -> str:
    """The key of the name that the text calls at its beginning or end; empty if there is none."""
    called = {key: _called(text, name, alike) for key, name in names.items()}
    found = {key: one[0] for key, one in called.items() if one}
    return max(found, key=lambda key: (found[key], key), default="")


def without_name(text: str, name: str) -> str:
    """The text without the name that it calls; the whole text if nothing is left."""
    called = _called(text, name, ALIKE)
    if called is None:
        return text
    _, start, end = called
    rest = (
        text[end:].lstrip(" ,.;:!?-\u3001\u3002\uff0c")
        if start == 0
        else text[:start].rstrip(" ,-\u3001\uff0c")
    )
    return rest if _WORD.search(rest) else text


def _called(text: str, name: str, alike: float) -> tuple[float, int, int] | None:
    """How like the name the words are that call it, and where they stand; None if none do.

    The text begins with the name, or its first clause ends with it ("hey Rosie, go"), or it ends
    with the name. What is before the name in a first clause goes with it.
    """
    wanted = _joined(_WORD.findall(name))
    words = list(_WORD.finditer(text))
    if not wanted or not words:
        return None
    clause_end = _CLAUSE_END.search(text)
    first = [word for word in words if clause_end and word.end() <= clause_end.start()]
    count = len(_WORD.findall(name))
    found: list[tuple[float, int, int]] = []
    for size in range(1, min(count + 1, len(words)) + 1):
        found.append((_likeness(words[:size], wanted), 0, words[size - 1].end()))
        found.append((_likeness(words[-size:], wanted), words[-size].start(), len(text)))
        if size < len(first) <= size + 1:
            found.append((_likeness(first[-size:], wanted), 0, first[-1].end()))
    best = max(found)
    needed = 1.0 if len(wanted) <= EXACT_TO else alike
    return best if best[0] >= needed else None


def without_phrase(text: str, phrase: str) -> str:
    """Return the text after the wake word, if that is near the beginning; else the whole text."""
    words = list(_WORD.finditer(text))
    wanted = _joined(_WORD.findall(phrase))
    best, end = 0.0, 0
    for first in range(min(len(words), MAX_WORDS_BEFORE + 1)):
        for count in range(1, len(_WORD.findall(phrase)) + 2):
            these = words[first : first + count]
            likeness = _likeness(these, wanted)
            if len(these) == count and likeness > best:
                best, end = likeness, these[-1].end()
    return text[end:].lstrip(" ,.;:!?-") if best >= PHRASE_ALIKE else text


def echoes(text: str, says: str) -> bool:
    """Whether the words of a text are mostly those of what another robot says."""
    words, said = (_TOKEN.findall(one.casefold()) for one in (text, says))
    pieces = SequenceMatcher(None, words, said, autojunk=False).get_matching_blocks()
    return bool(said) and sum(piece.size for piece in pieces) >= ECHOED * len(words)


def _likeness(words: Iterable["re.Match[str]"], wanted: str) -> float:
    said = _joined(word.group() for word in words)
    return SequenceMatcher(None, said, wanted, autojunk=False).ratio()


def _joined(words: Iterable[str]) -> str:
    return "".join(words).casefold()
