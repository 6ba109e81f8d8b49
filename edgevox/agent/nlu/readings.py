"""What calls a sentence could be, if it is a command at all: each grounded in what was said.

Every name and every number of the sentence stands in a call, and every value of a call was said.
Which skill is meant follows from the words that speak for one skill and not for the others. Nothing
here decides whether the speaker wants it done: that is for `judgement`.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.clauses import Clauses, Part
from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.mentions import Name, Number, find_names, find_numbers
from edgevox.agent.nlu.tokens import Words, find, is_mark
from edgevox.agent.skills import Call

_BESIDE = 3.0
"""What the words for a call without a name or a number must weigh at least, beside others."""
_MOST_PARTS = 12
MAX_TOKENS = 60
"""Longer sentences are stories."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A sentence as calls, in their order. `courteous` are the places of its courtesies."""

    parts: tuple[Part, ...]
    tokens: Words
    courteous: frozenset[int]
    strange: int
    corrected: bool
    denied: bool

    @property
    def calls(self) -> tuple[Call, ...]:
        """What would be done."""
        return tuple(part.call for part in self.parts)


class Reader:
    """Reads sentences as calls of the skills of a lexicon."""

    def __init__(self, lexicon: Lexicon) -> None:
        self._lexicon = lexicon
        words = lexicon.function_words
        split = lexicon.phrase
        self._fillers = [split(one) for one in words.fillers]
        self._joints = [split(one) for one in lexicon.book.hearing.joints]
        self._courtesies = [one for one in self._fillers if len(one) > 2]
        self._courtesies += [split(one) for one in (*words.asking, *words.wishes)]
        self._courtesies += [one for one in self._joints if len(one) > 1]
        self._reasons = [split(one) for one in words.reasons]
        self._negations = [split(one) for one in words.negations]
        self._corrections = [split(one) for one in words.corrections]
        self._reversals = [split(one) for one in words.reversals]
        self._articles = frozenset(split(one) for one in lexicon.book.hearing.articles)
        self._linking = frozenset(words.linking)

    def read(self, text: str) -> Reading | None:
        """The best reading; None where no skill could be meant."""
        tokens = self._lexicon.spelled(self._lexicon.tokenize(text))
        if not tokens or len(tokens) > MAX_TOKENS:
            return None
        joining = frozenset(_places(tokens, self._joints))
        said = [
            one
            for one in find_names(self._lexicon, tokens)
            if one.start not in joining and not self._is_article(tokens, one)
        ]
        names, denied = self._take_back(tokens, said)
        counted = find_numbers(tokens, self._linking)
        numbers = self._corrected(tokens, counted)
        corrected = len(names) < len(said) or len(numbers) < len(counted)
        gone = {at for one in said for at in range(one.start, one.end)}
        gone |= {one.start for one in counted}
        courteous = frozenset(_places(tokens, self._courtesies))
        filled = self._filled(tokens) | courteous | gone
        unsaid = frozenset(_places(tokens, self._negations)) if corrected else frozenset()
        sentence = Clauses(self._lexicon, tokens, names, numbers, filled, unsaid)
        parts = self._parts(sentence)
        if not parts:
            return None
        strange = sum(sentence.strange(a, b) for a, b in _gaps(parts, len(tokens)))
        strange += sum(part.strange for part in parts)
        parts = self._meant(parts)
        return Reading(
            _once(self._ordered(parts, tokens)), tokens, courteous, strange, corrected, denied
        )

    def _is_article(self, tokens: Words, one: Name) -> bool:
        """Whether it is the "the" of what follows, which elsewhere is "it"."""
        return one.end < len(tokens) and tokens[one.start : one.end] in self._articles

    def _filled(self, tokens: Words) -> frozenset[int]:
        filled = set(_places(tokens, [*self._fillers, *self._joints, *self._corrections]))
        filled |= {i for i, token in enumerate(tokens) if token in self._lexicon.common}
        return frozenset(filled)

    def _take_back(self, tokens: Words, names: Sequence[Name]) -> tuple[list[Name], bool]:
        """Without the names that the speaker took back: "the office, no, the bedroom"."""
        denied = set(_places(tokens, self._negations)) - set(_places(tokens, self._courtesies))
        correcting = set(_places(tokens, self._corrections))
        kept = list(names)
        allowed: set[int] = set()
        for first, second in itertools.pairwise(names):
            if first not in kept or first.values.keys().isdisjoint(second.values.keys()):
                continue
            between = set(range(first.end, second.start))
            before = set(range(max(0, first.start - 3), first.start))
            if between & correcting or before & denied:
                kept.remove(first)
                allowed |= set(range(max(0, first.start - 3), second.start))
        return kept, bool(denied - allowed)

    def _corrected(self, tokens: Words, numbers: Sequence[Number]) -> list[Number]:
        """Without a number that the next one corrects: "90 degrees, make that 60"."""
        correcting = set(_places(tokens, self._corrections))
        taken_back = {
            first.start
            for first, second in itertools.pairwise(numbers)
            if correcting & set(range(first.end, second.start))
        }
        return [one for one in numbers if one.start not in taken_back]

    def _parts(self, sentence: Clauses) -> tuple[Part, ...]:
        """The best way to part a sentence into calls, by dynamic programming over its borders."""
        borders = self._borders(sentence.tokens)
        best: list[tuple[float, tuple[Part, ...]] | None] = [None] * len(borders)
        best[0] = (0.0, ())
        for end in range(1, len(borders)):
            for start in range(max(0, end - _MOST_PARTS), end):
                before = best[start]
                if before is None:
                    continue
                for value, part in sentence.options(borders[start], borders[end], before[1]):
                    score = before[0] + value
                    if best[end] is None or score > best[end][0] + 1e-9:  # type: ignore[index]
                        best[end] = (score, (*before[1], *([part] if part else [])))
        return best[-1][1] if best[-1] else ()

    def _borders(self, tokens: Words) -> list[int]:
        borders = {0, len(tokens)}
        borders |= {at for at, token in enumerate(tokens) if is_mark(token)}
        borders |= {at for joint in self._joints for at in find(tokens, joint)}
        for words in (self._corrections, self._reversals, self._reasons):
            borders |= {at for one in words for at in find(tokens, one)}
        return sorted(borders)

    def _meant(self, parts: tuple[Part, ...]) -> tuple[Part, ...]:
        """Without what a stray word beside a real order speaks for."""
        if len(parts) < 2:
            return parts
        skills = self._lexicon.skills
        strong = [
            one
            for one in parts
            if one.grounded or skills[one.call.skill].moves or one.support >= _BESIDE
        ]
        return tuple(strong) or parts

    def _ordered(self, parts: tuple[Part, ...], tokens: Words) -> tuple[Part, ...]:
        """The order of doing: "before A, B" is B and then A, "A, but first B" too."""
        if len(parts) != 2:
            return parts
        second = parts[1]
        first_words = set(_places(tokens, self._reversals[:1]))
        opening = range(parts[0].start, min(parts[0].start + 2, len(tokens)))
        if first_words & set(opening):
            return second, parts[0]
        return parts


def _once(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """Without a name that is only said again: "the lab, they are in the lab"."""
    kept = [
        part
        for index, part in enumerate(parts)
        if not (index and part.call == parts[index - 1].call and not _counts(part.call))
    ]
    return tuple(kept)


def _counts(call: Call) -> bool:
    return any(isinstance(value, float) for value in call.arguments.values())


def _places(tokens: Words, phrases: Sequence[Words]) -> Iterator[int]:
    for phrase in phrases:
        if phrase:
            for start in find(tokens, phrase):
                yield from range(start, start + len(phrase))


def _gaps(parts: Sequence[Part], size: int) -> Iterator[tuple[int, int]]:
    at = 0
    for part in parts:
        yield at, part.start
        at = part.end
    yield at, size
