"""What calls a sentence could be, if it is a command at all: each grounded in what was said.

Every name and every number of the sentence stands in a call, and every value of a call was said.
Which skill is meant follows from the words that speak for one skill and not for the others. Nothing
here decides whether the speaker wants it done: that is for `judgement`.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from edgevox.agent.arguments import check_arguments
from edgevox.agent.nlu.lexicon import Lexicon, SkillWords
from edgevox.agent.nlu.mentions import Name, Number, find_names, find_numbers
from edgevox.agent.nlu.tokens import Words, find, is_mark, is_number
from edgevox.agent.skills import STOP, Call
from edgevox.core.errors import InvalidValue

_CALL_COSTS = 1.0
_STRANGE_COSTS = 0.25
_PLAIN, _BARE = 0.0, 1.2
"""What the words must weigh at least that speak for a skill, where a name or a number is said that
it takes, and where none is."""
_BESIDE = 3.0
"""The same for a call without any, beside others."""
_MOST_PARTS = 7
MAX_TOKENS = 60
"""Longer sentences are stories."""


@dataclass(frozen=True, slots=True)
class Part:
    """One call of a reading, and how well the words from `start` to `end` speak for it.

    `support` are the weights of the words that speak for its skill, `rival` those for the next one,
    `grounded` how many values were said, `strange` the words that no skill and no courtesy knows.
    """

    call: Call
    start: int
    end: int
    support: float
    rival: float
    grounded: int
    strange: int
    nearly: bool
    unitless: bool
    unfilled: int


@dataclass(frozen=True, slots=True)
class Reading:
    """A sentence as calls, in their order."""

    parts: tuple[Part, ...]
    tokens: Words
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
        split = lexicon.tokenize
        self._fillers = [split(one) for one in words.fillers]
        polite = [split(one) for one in words.fillers]
        self._courtesies = [one for one in polite if len(one) > 2]
        self._courtesies += [split(one) for one in words.asking]
        self._negations = [split(one) for one in words.negations]
        self._corrections = [split(one) for one in words.corrections]
        self._reversals = [split(one) for one in words.reversals]
        self._joints = [split(one) for one in lexicon.book.hearing.joints]
        self._linking = frozenset(
            {"is", "equals", "=", "ist", "gleich", "est", "es", "igual", "at"}
        )

    def read(self, text: str) -> Reading | None:
        """The best reading; None where no skill could be meant."""
        tokens = self._lexicon.spelled(self._lexicon.tokenize(text))
        if not tokens or len(tokens) > MAX_TOKENS:
            return None
        joining = frozenset(_places(tokens, self._joints))
        said = [one for one in find_names(self._lexicon, tokens) if one.start not in joining]
        names, denied = self._take_back(tokens, said)
        counted = find_numbers(tokens, self._linking)
        numbers = self._corrected(tokens, counted)
        corrected = len(names) < len(said) or len(numbers) < len(counted)
        gone = {at for one in said for at in range(one.start, one.end)}
        gone |= {one.start for one in counted}
        filled = self._filled(tokens) | gone
        sentence = _Sentence(self._lexicon, tokens, names, numbers, filled)
        parts = self._parts(sentence)
        if not parts:
            return None
        strange = sum(sentence.strange(a, b) for a, b in _gaps(parts, len(tokens)))
        strange += sum(part.strange for part in parts)
        parts = self._meant(parts)
        return Reading(_once(self._ordered(parts, tokens)), tokens, strange, corrected, denied)

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

    def _parts(self, sentence: "_Sentence") -> tuple[Part, ...]:
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
        for words in (self._corrections, self._reversals):
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


class _Sentence:
    """One sentence while it is read."""

    def __init__(
        self,
        lexicon: Lexicon,
        tokens: Words,
        names: Sequence[Name],
        numbers: Sequence[Number],
        filled: frozenset[int],
    ) -> None:
        self.tokens = tokens
        self._lexicon = lexicon
        self._names = names
        self._numbers = numbers
        self._named = frozenset(i for one in names for i in range(one.start, one.end))
        self._filled = filled
        functions = lexicon.function_words.fillers
        self._filled_words = {at for at, token in enumerate(tokens) if token in functions}

    def options(
        self, start: int, end: int, before: tuple[Part, ...]
    ) -> Iterator[tuple[float, Part | None]]:
        """What the words between two borders may be, with how good that is."""
        inside = [one for one in self._names if start <= one.start < end]
        names = [one for one in inside if not self._is_weak(one)]
        numbers = [one for one in self._numbers if start <= one.start < end]
        if any(one.end > end for one in inside):
            return
        if not names and not numbers:
            yield -_STRANGE_COSTS * self.strange(start, end), None
        parts = [
            part
            for words in self._lexicon.words.values()
            if words.skill.name != STOP and (names or not words.skill.choices)
            for chosen in ([inside, names] if len(inside) > len(names) else [names])
            for part in self._calls(words, start, end, chosen, numbers)
            if part.support >= (_PLAIN if names or numbers else _BARE)
        ]
        parts = [one for one in parts if one.support > 0 or _is_alone(one, parts)]
        ranked = sorted(parts, key=lambda one: (one.support, one.grounded), reverse=True)
        for index, part in enumerate(ranked[:3]):
            others = [o.support for o in ranked if o.call.skill != part.call.skill]
            rival = max(others, default=0.0)
            again = any(part.call.skill == one.call.skill for one in before)
            value = part.support + 0.6 * part.grounded - _STRANGE_COSTS * part.strange
            yield value - _CALL_COSTS + 0.3 * again - 0.01 * index, replace(part, rival=rival)

    def _is_weak(self, one: Name) -> bool:
        """Whether these words may just as well mean nothing: "it", "that"."""
        return all(at in self._filled_words for at in range(one.start, one.end))

    def strange(self, start: int, end: int, words: SkillWords | None = None) -> int:
        """How many words are neither a name, a number, a courtesy nor a word of this skill."""
        known = words.weights if words else {}
        return sum(
            not (
                at in self._named
                or at in self._filled
                or is_mark(token)
                or is_number(token)
                or token in known
            )
            for at, token in enumerate(self.tokens[start:end], start)
        )

    def _calls(
        self,
        words: SkillWords,
        start: int,
        end: int,
        names: Sequence[Name],
        numbers: Sequence[Number],
    ) -> Iterator[Part]:
        units = frozenset().union(*words.units.values()) if words.units else frozenset()
        for arguments, unitless in _assigned(words, tuple(names), tuple(numbers)):
            try:
                check_arguments(words.skill.name, words.skill.arguments_model, arguments)
            except InvalidValue:
                continue
            seen = {
                token: words.weights[token]
                for at, token in enumerate(self.tokens[start:end], start)
                if token in words.weights and at not in self._named and token not in units
            }
            yield Part(
                Call(words.skill.name, arguments),
                start,
                end,
                sum(seen.values()),
                0.0,
                len(arguments),
                self.strange(start, end, words),
                any(one.nearly for one in names),
                unitless,
                len(words.skill.choices.keys() - arguments.keys()),
            )


def _assigned(
    words: SkillWords, names: tuple[Name, ...], numbers: tuple[Number, ...]
) -> Iterator[tuple[Mapping[str, Any], bool]]:
    """Every way in which these names and numbers are the arguments of a skill, all of them used."""
    counted = _counted(words, numbers)
    if counted is None:
        return
    values, unitless = counted
    slots = list(words.skill.choices)
    for chosen in itertools.permutations(slots, len(names)):
        pairs = list(zip(chosen, names, strict=True))
        if all((words.skill.name, slot) in one.values for slot, one in pairs):
            named = {slot: one.values[words.skill.name, slot] for slot, one in pairs}
            arguments = named | values
            if _required(words) <= arguments.keys():
                yield arguments, unitless
                return


def _is_alone(one: Part, parts: Sequence[Part]) -> bool:
    """Whether no other skill takes as many of the names and numbers."""
    return all(o.call.skill == one.call.skill or o.grounded < one.grounded for o in parts)


def _required(words: SkillWords) -> set[str]:
    fields = words.skill.arguments_model.model_fields
    return {name for name, info in fields.items() if info.is_required()}


def _counted(words: SkillWords, numbers: tuple[Number, ...]) -> tuple[dict[str, Any], bool] | None:
    """The numbers as arguments: by their axes, or in their order; None where they do not fit."""
    slots = words.numbers
    if not numbers:
        return {}, False
    if len(numbers) > len(slots):
        return None
    by_axis = {one.axis: one.value for one in numbers if one.axis in slots}
    if len(by_axis) == len(numbers):
        return dict(by_axis), False
    if by_axis or len(numbers) != len(slots):
        return None
    unitless = False
    for slot, one in zip(slots, numbers, strict=True):
        known = words.units.get(slot, frozenset())
        if known and one.unit not in known:
            if one.unit and one.unit not in words.weights:
                return None
            unitless = True
    return {slot: one.value for slot, one in zip(slots, numbers, strict=True)}, unitless


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
