"""Finds in a sentence what the arguments of skills may be: names that they know, and numbers."""

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.tokens import Words, is_mark, is_number
from edgevox.agent.spelling import ENDING, is_same_name

_NEARLY = 0.8
"""How alike two spellings of one name are at least."""
_AXES = frozenset({"x", "y", "z"})
_SHORTEST = 4
"""A shorter name is not looked for in other spellings."""


@dataclass(frozen=True, slots=True)
class Name:
    """Words from `start` up to but without `end` that name a value of some arguments.

    `values` are the words of each skill's argument that they stand for; `nearly` says that they are
    spelled otherwise, `guessed` that not even their letters are the same.
    """

    start: int
    end: int
    values: Mapping[tuple[str, str], str]
    nearly: bool = False
    guessed: bool = False


@dataclass(frozen=True, slots=True)
class Number:
    """A number, with the letter of the axis before it and the word after it."""

    start: int
    value: float
    axis: str
    unit: str

    @property
    def end(self) -> int:
        """Where it ends."""
        return self.start + 1


def find_names(lexicon: Lexicon, tokens: Words) -> list[Name]:
    """Names in their order; of overlapping ones the longest."""
    found: dict[tuple[int, int], dict[tuple[str, str], str]] = {}
    for place, names in lexicon.names.items():
        for start, end, word in _exactly(names, tokens):
            found.setdefault((start, end), {})[place] = word
    chosen = _longest([Name(start, end, values) for (start, end), values in found.items()])
    near: dict[tuple[int, int], dict[tuple[str, str], str]] = {}
    guessed: set[tuple[int, int]] = set()
    for place, names in lexicon.names.items():
        for start, end, word, alike in _nearly(names, tokens, lexicon):
            if not any(one.start < end and start < one.end for one in chosen):
                near.setdefault((start, end), {})[place] = word
                guessed |= set() if alike else {(start, end)}
    added = [
        Name(*place, values, nearly=True, guessed=place in guessed)
        for place, values in near.items()
    ]
    return sorted([*chosen, *_longest(added)], key=lambda one: one.start)


def find_numbers(tokens: Words, linking: frozenset[str]) -> list[Number]:
    """Numbers in their order. `linking` words may stand between an axis and its number."""
    return [
        Number(at, float(token), _axis(tokens, at, linking), _unit(tokens, at))
        for at, token in enumerate(tokens)
        if is_number(token)
    ]


def _axis(tokens: Words, at: int, linking: frozenset[str]) -> str:
    before = at - 1
    while before >= 0 and tokens[before] in linking:
        before -= 1
    letter = tokens[before] if before >= 0 else ""
    return letter if letter in _AXES else _axis_behind(tokens, at)


def _axis_behind(tokens: Words, at: int) -> str:
    """The axis in "five metres x, one metre y"; in "5 x 3" the letter may stand for "by"."""
    for behind in (at + 1, at + 2):
        letter, after = (*tokens[behind : behind + 2], "", "")[:2]
        if letter in _AXES and not is_number(after):
            return letter
    return ""


def _unit(tokens: Words, at: int) -> str:
    return tokens[at + 1] if at + 1 < len(tokens) and not is_mark(tokens[at + 1]) else ""


def _exactly(names: Mapping[Words, str], tokens: Words) -> Iterator[tuple[int, int, str]]:
    sizes = {len(name) for name in names}
    for start in range(len(tokens)):
        for size in sizes:
            word = names.get(tokens[start : start + size])
            if word is not None and start + size <= len(tokens):
                yield start, start + size, word


def _nearly(
    names: Mapping[Words, str], tokens: Words, lexicon: Lexicon
) -> Iterator[tuple[int, int, str, bool]]:
    """Names in another spelling: one word for two, two for one, or a slip of the fingers.

    With each comes whether at least its letters are the same.
    """
    if not lexicon.book.hearing.spaced:
        return
    joined = {"".join(name): word for name, word in names.items()}
    inflected = lexicon.book.fallback is not None
    for start in range(len(tokens)):
        for size in (2, 1, 3):
            parts = tokens[start : start + size]
            if len(parts) < size or any(is_mark(p) or is_number(p) for p in parts):
                continue
            said = "".join(parts)
            if len(said) < _SHORTEST or (size == 1 and lexicon.knows(said)):
                continue
            for near in difflib.get_close_matches(said, joined, n=1, cutoff=_NEARLY):
                if len(near) >= _SHORTEST and _begins_alike(said, near):
                    alike = is_same_name(said, near, inflected=inflected)
                    yield start, start + size, joined[near], alike


def _begins_alike(said: str, name: str) -> bool:
    if len(said) > len(name) + ENDING and (said.startswith(name) or said.endswith(name)):
        return False  # a word of its own: a bedroom lamp is no bedroom
    return said[0] == name[0] or (said[-2:] == name[-2:] and len(said) == len(name))


def _longest(names: Sequence[Name]) -> list[Name]:
    chosen: list[Name] = []
    for one in sorted(names, key=lambda n: (n.start - n.end, n.start)):
        if not any(other.start < one.end and one.start < other.end for other in chosen):
            chosen.append(one)
    return sorted(chosen, key=lambda n: n.start)
