"""Clauses: the words between two borders of a sentence as one call of a skill, or as talk.

`find_names` and `find_numbers` find the values for arguments: names that skills know, and numbers.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from edgevox.agent.nlu.lexicon import Lexicon, SkillWords, Words, is_mark, is_number, plain
from edgevox.agent.skills import STOP, Call
from edgevox.agent.skills.arguments import check_arguments
from edgevox.agent.text.alike import most_alike
from edgevox.agent.text.spelling import ENDING, is_same_name
from edgevox.core.errors import InvalidValue

_NEARLY = 0.8
"""Least similarity of two spellings of one name, from 0 to 1."""
_AXES = frozenset({"x", "y", "z"})
_SHORTEST = 4
"""Number of letters from which on a name is looked for in other spellings."""


@dataclass(frozen=True, slots=True)
class Name:
    """Words of a sentence that name a value of some arguments."""

    start: int
    """Index of the first word."""
    end: int
    """Index after the last word."""
    values: Mapping[tuple[str, str], str]
    """The value for each pair of a skill and its argument."""
    nearly: bool = False
    """True if the name is spelled in another way."""
    guessed: bool = False
    """True if even its letters differ."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a sentence."""

    start: int
    """Index of its token."""
    value: float
    """Its value."""
    axis: str
    """The letter of its axis; empty without one."""
    unit: str
    """The word after it; empty without one."""

    @property
    def end(self) -> int:
        """Index after its token."""
        return self.start + 1


def find_names(lexicon: Lexicon, tokens: Words) -> list[Name]:
    """Names in a sentence, in their order; of overlapping ones the longest."""
    found: dict[tuple[int, int], dict[tuple[str, str], str]] = {}
    for place, names in lexicon.names.items():
        for start, end, word in _exactly(names, tokens):
            found.setdefault((start, end), {})[place] = word
    wider = [span for span in _usual_spans(lexicon, tokens) if span not in found]
    for start, end in [*found]:
        if any(at <= start and end <= to for at, to in wider):
            del found[start, end]  # "sala" of "sala da pranzo"
    chosen = _longest([Name(start, end, values) for (start, end), values in found.items()])
    near: dict[tuple[int, int], dict[tuple[str, str], str]] = {}
    guessed: set[tuple[int, int]] = set()
    for place, joined in lexicon.joined.items():
        for start, end, word, alike in _nearly(joined, tokens, lexicon):
            taken = (*wider, *((one.start, one.end) for one in chosen))
            if not any(at < end and start < to for at, to in taken):
                near.setdefault((start, end), {})[place] = word
                guessed |= set() if alike else {(start, end)}
    added = [
        Name(*place, values, nearly=True, guessed=place in guessed)
        for place, values in near.items()
    ]
    return sorted([*chosen, *_longest(added)], key=lambda one: one.start)


def _usual_spans(lexicon: Lexicon, tokens: Words) -> list[tuple[int, int]]:
    """Where names of usual places of several words are said."""
    several = {name: one for name, one in lexicon.usual_places.items() if len(name) > 1}
    return [(start, end) for start, end, _ in _exactly(several, tokens)]


def find_place(tokens: Words, lexicon: Lexicon) -> str:
    """The first usual place in a sentence that is no name that skills know; empty for none."""
    places = lexicon.usual_places
    named = {at for one in find_names(lexicon, tokens) for at in range(one.start, one.end)}
    inflected = lexicon.book.fallback is not None and lexicon.book.hearing.spaced
    for start in range(len(tokens)):
        for size in (3, 2, 1):
            said = tokens[start : start + size]
            if len(said) < size or named.intersection(range(start, start + size)):
                continue
            if said in places:
                return places[said]
            alike = " ".join(said)
            if inflected and len(alike) >= _SHORTEST:
                same = (one for one in places if is_same_name(alike, " ".join(one), inflected=True))
                if place := next(same, None):
                    return places[place]
    return ""


def find_numbers(tokens: Words, linking: frozenset[str]) -> list[Number]:
    """Numbers in a sentence. `linking` words may stand between an axis and its number."""
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
    joined: Mapping[str, str], tokens: Words, lexicon: Lexicon
) -> Iterator[tuple[int, int, str, bool]]:
    """Names in another spelling: one word for two, two for one, or a typing error.

    Each comes with its borders, its value, and whether its letters are the same. `joined` are the
    names in one word; what is most like one without a value is none.
    """
    if not lexicon.book.hearing.spaced:
        return
    inflected = lexicon.book.fallback is not None
    for start in range(len(tokens)):
        for size in (2, 1, 3):
            parts = tokens[start : start + size]
            if len(parts) < size or any(is_mark(p) or is_number(p) for p in parts):
                continue
            said = "".join(parts)
            if len(said) < _SHORTEST or (size == 1 and lexicon.knows(said)):
                continue
            for near in most_alike(said, joined, least=_NEARLY):
                if joined[near] and len(near) >= _SHORTEST and _begins_alike(said, near):
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


_CALL_COSTS = 1.0
_STRANGE_COSTS = 0.25
_STRANGE_INSIDE_COSTS = 0.27
"""Higher than the cost outside: strange words after a border are better left out of a call."""
_PLAIN, _BARE = 0.0, 1.2
"""Least weights of the words that speak for a skill: for a drive with a said name or number, and
for any other call."""


@dataclass(frozen=True, slots=True)
class ClauseReading:
    """A clause read as one call."""

    call: Call
    """The call."""
    start: int
    """Index of the clause's first token."""
    end: int
    """Index after its last token."""
    support: float
    """Weight of the words that speak for the skill."""
    told: float
    """Weight of those among them that stand in the skill's templates."""
    rival: float
    """Weight of the words that speak for the next best skill."""
    grounded: int
    """Number of arguments whose values were said."""
    strange: int
    """Number of words that no skill and no courtesy knows."""
    nearly: bool
    """True if a name was spelled in another way."""
    guessed: bool
    """True if a name was said in other letters."""
    unitless: bool
    """True if a number lacks its unit."""
    unfilled: int
    """Number of the skill's word arguments without a value."""


class Clauses:
    """The clauses of one sentence while it is read."""

    def __init__(
        self,
        lexicon: Lexicon,
        tokens: Words,
        names: Sequence[Name],
        numbers: Sequence[Number],
        *,
        filled: frozenset[int],
        unsaid: frozenset[int] = frozenset(),
    ) -> None:
        self.tokens = tokens
        self._lexicon = lexicon
        self._names = names
        self._numbers = numbers
        self._named = frozenset(i for one in names for i in range(one.start, one.end))
        self._filled = filled
        self._unsaid = unsaid  # words that only take something back
        functions = lexicon.function_words.fillers
        self._fillers = frozenset((*map(plain, functions), *lexicon.common))
        self._pronouns = frozenset(lexicon.function_words.pronouns)
        self._filled_words = {at for at, token in enumerate(tokens) if token in functions}

    def options(
        self, start: int, end: int, before: tuple[ClauseReading, ...]
    ) -> Iterator[tuple[float, ClauseReading | None]]:
        """The readings of the words between two borders, each with its score; None for talk."""
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
            if part.support >= (_PLAIN if self._may_be_short(part, chosen) else _BARE)
        ]
        parts = [one for one in parts if one.support > 0 or _is_alone(one, parts)]
        ranked = sorted(parts, key=lambda one: (one.support, one.grounded), reverse=True)
        for index, part in enumerate(ranked[:3]):
            others = [o.support for o in ranked if o.call.skill != part.call.skill]
            rival = max(others, default=0.0)
            again = any(part.call.skill == one.call.skill for one in before)
            value = part.support + 0.6 * part.grounded - _STRANGE_INSIDE_COSTS * part.strange
            yield value - _CALL_COSTS + 0.3 * again - 0.01 * index, replace(part, rival=rival)

    def whole(self, words: SkillWords) -> ClauseReading | None:
        """All words as one call of this skill that takes every name and number, or None."""
        calls = self._calls(words, 0, len(self.tokens), self._names, self._numbers)
        return next(calls, None)

    def _may_be_short(self, part: ClauseReading, names: Sequence[Name]) -> bool:
        """True if the call may lack its verb: "the kitchen, please" can only ask for a drive.

        "The red one, go for it" asks to put nothing: its "it" may as well mean nothing.
        """
        drives = self._lexicon.skills[part.call.skill].drives
        return part.grounded > 0 and drives and not any(map(self._is_weak, names))

    def _is_weak(self, one: Name) -> bool:
        """True if these words may as well mean nothing: "it", "that"."""
        return all(at in self._filled_words for at in range(one.start, one.end))

    def strange(self, start: int, end: int, words: SkillWords | None = None) -> int:
        """Number of words that are no name, number, courtesy or word of this skill."""
        known = words.weights if words else {}
        return sum(
            self._is_thing(at, known)
            or not (
                at in self._named
                or at in self._filled
                or is_mark(token)
                or is_number(token)
                or token in known
            )
            for at, token in enumerate(self.tokens[start:end], start)
        )

    def _is_thing(self, at: int, known: Mapping[str, float]) -> bool:
        """True if a pronoun stands for a thing that no skill takes: "bring it to the kitchen"."""
        if at in self._named or self.tokens[at] not in self._pronouns:
            return False
        before = self.tokens[at - 1] if at else ""
        after = self.tokens[at + 1 : at + 2]
        return known.get(before, 0.0) > 0 and not any(map(is_mark, after)) and bool(after)

    def _calls(
        self,
        words: SkillWords,
        start: int,
        end: int,
        names: Sequence[Name],
        numbers: Sequence[Number],
    ) -> Iterator[ClauseReading]:
        units = words.measures.union(*words.units.values())
        if not self._may_be_a_point(numbers):
            return
        for arguments, unitless in _assigned(words, tuple(names), tuple(numbers)):
            try:
                check_arguments(words.skill.name, words.skill.arguments_model, arguments)
            except InvalidValue:
                continue
            seen = {
                token: words.weights[token]
                for at, token in enumerate(self.tokens[start:end], start)
                if token in words.weights
                and at not in self._named
                and at not in self._unsaid
                and token not in units
            }
            yield ClauseReading(
                Call(words.skill.name, arguments),
                start,
                end,
                sum(seen.values()),
                sum(weight for token, weight in seen.items() if token not in words.shown),
                0.0,
                len(arguments),
                self.strange(start, end, words),
                any(one.nearly for one in names),
                any(one.guessed for one in names),
                unitless,
                len(words.skill.choices.keys() - arguments.keys()),
            )

    def _may_be_a_point(self, numbers: Sequence[Number]) -> bool:
        """False if several numbers without axes are no point: "3 by 4", unlike "to 3, 4"."""
        if len(numbers) < 2 or any(one.axis for one in numbers):
            return True
        joints = frozenset({plain(self._lexicon.book.hearing.pair)})
        for one, other in itertools.pairwise(numbers):
            between = self.tokens[one.end : other.start]
            if not all(is_mark(token) or token in joints for token in between):
                return False
        first = numbers[0].start
        before = self.tokens[first - 1] if first else ""
        if is_mark(before):
            before = self.tokens[first - 2] if first > 1 else ""
        return before in self._fillers or self._lexicon.says_a_point(before)


def _assigned(
    words: SkillWords, names: tuple[Name, ...], numbers: tuple[Number, ...]
) -> Iterator[tuple[Mapping[str, Any], bool]]:
    """Arguments of a skill that use all these names and numbers, and whether a unit is missing."""
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


def _is_alone(one: ClauseReading, parts: Sequence[ClauseReading]) -> bool:
    """True if no other skill takes as many of the names and numbers."""
    return all(o.call.skill == one.call.skill or o.grounded < one.grounded for o in parts)


def _required(words: SkillWords) -> set[str]:
    fields = words.skill.arguments_model.model_fields
    return {name for name, info in fields.items() if info.is_required()}


def _counted(words: SkillWords, numbers: tuple[Number, ...]) -> tuple[dict[str, Any], bool] | None:
    """The numbers as arguments, by their axes or in their order; None if they do not fit.

    The second value is True if a number lacks its unit.
    """
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
