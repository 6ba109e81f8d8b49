"""The reading of a sentence as calls of skills, each grounded in the words.

Every name and every number of the sentence is a value of a call, and every value of a call was
said. The words that speak for one skill and not for others choose the skill. `decider` decides
later whether the speaker wants the calls done.
"""

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from edgevox.agent.nlu.clauses import ClauseReading, Clauses, Name, Number, find_names, find_numbers
from edgevox.agent.nlu.lexicon import Lexicon, Words, is_mark
from edgevox.agent.nlu.remainder import speaks_of_motion
from edgevox.agent.skills import Call

_BESIDE = 3.0
"""Least weight of the words for a call without a name or number, beside other calls."""
_MOST_PARTS = 12
MAX_TOKENS = 60
"""Number of tokens from which on a sentence is a story, not a command."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A sentence read as calls."""

    parts: tuple[ClauseReading, ...]
    """The clauses that are calls, in the order of doing."""
    tokens: Words
    """The tokens of the sentence."""
    courteous: frozenset[int]
    """Indices of the tokens in courtesies."""
    strange: int
    """Number of unknown words."""
    corrected: bool
    """True if the speaker took something back."""
    ambiguous: bool
    """True if what took something back may deny what follows: "a la cocina no al despacho"."""
    denied: bool
    """True if a negation denies something that was not taken back."""
    unread: bool
    """True if a joint opens words that are no call and not all known: perhaps another order."""

    @property
    def calls(self) -> tuple[Call, ...]:
        """The calls of all parts."""
        return tuple(part.call for part in self.parts)


class CallReader:
    """Reads sentences as calls of the skills of a lexicon."""

    def __init__(self, lexicon: Lexicon) -> None:
        self._lexicon = lexicon
        words = lexicon.function_words
        joints = lexicon.book.hearing.joints
        courtesies = (one for one in words.fillers if len(lexicon.phrase(one)) > 2)
        linked = (one for one in joints if len(lexicon.phrase(one)) > 1)
        self._joints = lexicon.index(joints)
        self._prefixes = tuple(one for one in joints if len(one) == 1 and one > "z")
        self._courtesies = lexicon.index((*courtesies, *words.asking, *words.wishes, *linked))
        self._filling = lexicon.index(
            (*words.fillers, *words.urges, *words.little, *joints, *words.corrections)
        )
        self._negations = lexicon.index(words.negations)
        self._denying = {one for some in map(lexicon.phrase, words.negations) for one in some}
        self._corrections = lexicon.index(words.corrections)
        denials = () if lexicon.book.hearing.denials_follow else lexicon.book.answers.not_
        self._denials = lexicon.index(denials)
        taking_back = {*lexicon.book.answers.no, *words.corrections}
        self._contrasts = lexicon.index(tuple(o for o in denials if o not in taking_back))
        self._reversal = lexicon.index(words.reversals[:1])
        self._opening = lexicon.index(
            (*joints, *words.corrections, *words.reversals, *words.reasons)
        )
        self._articles = frozenset(map(lexicon.phrase, lexicon.book.hearing.articles))
        self._linking = frozenset(words.linking)

    def read(self, text: str) -> Reading | None:
        """The best reading; None if no skill could be meant."""
        written = self._lexicon.tokenize(text)
        tokens = self._lexicon.spelled(written)
        if not tokens or len(tokens) > MAX_TOKENS:
            return None
        joining = self._joints.places(tokens)
        said = [
            one
            for one in _as_written(find_names(self._lexicon, tokens), tokens, written)
            if one.start not in joining and not self._is_article(tokens, one)
        ]
        names, unsure, denied = self._take_back(tokens, said)
        ambiguous = unsure or any(
            self._denials.places(tokens).intersection(range(one.end, other.start))
            for one, other in itertools.pairwise(said)
            if one not in names
        )
        counted = self._numbers(tokens, said)
        numbers = self._corrected(tokens, counted)
        corrected = len(names) < len(said) or len(numbers) < len(counted)
        gone = {at for one in said for at in range(one.start, one.end)}
        gone |= {one.start for one in counted}
        courteous = self._courtesies.places(tokens)
        filled = self._filled(tokens) | courteous | gone
        unsaid = self._negations.places(tokens) if corrected else frozenset()
        sentence = Clauses(self._lexicon, tokens, names, numbers, filled=filled, unsaid=unsaid)
        parts = self._parts(sentence)
        if not parts:
            return None
        strange = sum(sentence.strange(a, b) for a, b in _gaps(parts, len(tokens)))
        strange += sum(part.strange for part in parts)
        gaps = [(a, b) for a, b in _gaps(parts, len(tokens)) if a in joining]
        unread = any(sentence.strange(a, b) or self._speaks(tokens, a, b) for a, b in gaps)
        taken = gone | {at for one in said for at in range(one.start, one.end)}
        unread = unread or any(self._is_half_read(part, sentence, taken) for part in parts)
        parts = self._meant(parts)
        if self._takes_back(parts, tokens, gone):
            parts, corrected, denied = parts[1:], True, False
        return Reading(
            _once(self._ordered(parts, tokens)),
            tokens,
            courteous,
            strange,
            corrected,
            ambiguous,
            denied,
            unread,
        )

    def _speaks(self, tokens: Words, start: int, end: int) -> bool:
        """True if a word here speaks for a motion, and is no courtesy: perhaps another order."""
        courteous = self._courtesies.places(tokens)
        return any(
            speaks_of_motion(tokens[at], self._lexicon)
            for at in range(start, end)
            if at not in courteous and tokens[at] not in self._lexicon.function_words.fillers
        )

    def whole(self, text: str, skills: Collection[str]) -> Reading | None:
        """The text as one call of one of these skills, whatever its other words; None if none fits.

        Every name and number is a value of the call.
        """
        written = self._lexicon.tokenize(text)
        tokens = self._lexicon.spelled(written)
        if not tokens or len(tokens) > MAX_TOKENS:
            return None
        names = list(_as_written(find_names(self._lexicon, tokens), tokens, written))
        numbers = self._numbers(tokens, names)
        courteous = self._courtesies.places(tokens)
        filled = self._filled(tokens) | courteous
        sentence = Clauses(self._lexicon, tokens, names, numbers, filled=filled)
        joints = self._joints.starts(tokens) - courteous
        if any(sentence.strange(at, len(tokens)) for at in joints):
            return None  # perhaps another order
        denied = bool(self._negations.places(tokens) - courteous)
        for name in self._lexicon.words.keys() & skills:
            if part := sentence.whole(self._lexicon.words[name]):
                return Reading(
                    (part,), tokens, courteous, part.strange, False, False, denied, unread=False
                )
        return None

    def _is_half_read(self, part: ClauseReading, sentence: Clauses, taken: set[int]) -> bool:
        """True if unknown words in a call may be another order, or a thing that no skill takes.

        Such words follow a joint ("and wash it"), follow the verb of a language without spaces, or
        follow an article: "turn off the lamp in the bedroom".
        """
        tokens, end = sentence.tokens, part.end
        words = self._lexicon.words[part.call.skill]
        strange = [at for at in range(part.start, end) if sentence.strange(at, at + 1, words)]
        values = [at for at in range(part.start, end) if at in taken]
        if not (strange and values):
            return False
        behind = [at for at in strange if at > values[-1]]
        joints = self._joints.starts(tokens)
        if behind and not self._lexicon.book.hearing.spaced:
            return any(tokens[at] in words.weights for at in range(values[-1] + 1, behind[0]))
        if any(values[-1] < at <= one for one in behind for at in joints):
            return True
        if any(tokens[at].startswith(self._prefixes) for at in behind):
            return True
        return any(
            (tokens[at - 1],) in self._articles
            and any(one not in strange for one in range(at + 1, values[0]))
            for at in strange
            if part.start < at < values[0]
        )

    def _numbers(self, tokens: Words, names: Sequence[Name]) -> list[Number]:
        """The numbers that are no part of a name: "the red one"."""
        named = {at for one in names for at in range(one.start, one.end)}
        return [one for one in find_numbers(tokens, self._linking) if one.start not in named]

    def _is_article(self, tokens: Words, one: Name) -> bool:
        """True if the name is an article here, a word that elsewhere means "it"."""
        return one.end < len(tokens) and tokens[one.start : one.end] in self._articles

    def _filled(self, tokens: Words) -> frozenset[int]:
        common = {i for i, token in enumerate(tokens) if token in self._lexicon.common}
        return self._filling.places(tokens) | common

    def _take_back(self, tokens: Words, names: Sequence[Name]) -> tuple[list[Name], bool, bool]:
        """The names that were not taken back, whether that may be wrong, and a denial.

        "The office, no, the bedroom" takes back the first, "not the office" behind another one
        leaves it out. It may be wrong where a denial stands before a name, or leaves one out.
        """
        denied = self._negations.places(tokens) - self._courtesies.places(tokens)
        correcting = self._correcting(tokens)
        kept, unsure = list(names), False
        allowed: set[int] = set()
        for first, second in itertools.pairwise(names):
            if first not in kept or first.values.keys().isdisjoint(second.values.keys()):
                continue
            between = range(first.end, second.start)
            opening = self._opening_of(tokens, first, between)
            before = opening & (denied - allowed)
            if second is names[-1] and self._leaves_out(tokens, between):
                kept.remove(second)
                allowed |= set(between)
                unsure = True
                continue
            if self._denies_behind(tokens, between) or self._denies_next(tokens, between):
                return kept, unsure, True
            if before and self._denies_both(tokens, between, denied - correcting):
                return kept, unsure, True
            if correcting.intersection(between) or before:
                kept.remove(first)
                allowed |= opening | {*range(first.start, second.start)}
                unsure = unsure or bool(before)
        return kept, unsure, bool(denied - allowed)

    def _opening_of(self, tokens: Words, name: Name, behind: range) -> set[int]:
        """The places of the words before a name that may deny it.

        Those are three, or the whole of "do not go to the", if a motion of another clause follows
        the name and no word joins it: "..., go to the office".
        """
        near = set(range(max(0, name.start - 3), name.start))
        joined = self._joints.places(tokens).intersection(behind)
        if (
            joined
            or not any(is_mark(tokens[at]) for at in behind)
            or not self._moves(tokens, behind)
        ):
            return near
        backwards = range(name.start - 1, -1, -1)
        start = next((at for at in backwards if not self._is_small(tokens[at])), -1) + 1
        return near | {*range(start, name.start)}

    def _moves(self, tokens: Words, places: range) -> bool:
        """True if a word here urges to move, or speaks for a motion."""
        urges = self._lexicon.function_words.urges
        return any(
            tokens[at] in urges or speaks_of_motion(tokens[at], self._lexicon) for at in places
        )

    def _is_small(self, word: str) -> bool:
        """True for a word that denies, fills, or speaks for a motion."""
        return (
            word in self._denying
            or word in self._lexicon.function_words.fillers
            or word in self._lexicon.common
            or speaks_of_motion(word, self._lexicon)
        )

    def _leaves_out(self, tokens: Words, between: range) -> bool:
        """True if what is between two names leaves the second out: "the office, not the bedroom".

        Only marks and joints may stand before the word that denies.
        """
        if not self._denies_next(tokens, between):
            return False
        first = min(self._contrasts.places(tokens).intersection(between))
        parted = self._joints.places(tokens)
        return all(is_mark(tokens[at]) or at in parted for at in range(between.start, first))

    def _correcting(self, tokens: Words) -> frozenset[int]:
        """Where words correct what is before them: "instead", but not that of "instead of"."""
        found = self._negations.find(tokens)
        long = (range(at, at + len(one)) for at, one in found if len(one) > 1)
        return self._corrections.places(tokens).difference(*long)

    def _denies_next(self, tokens: Words, between: range) -> bool:
        """True if a word that only denies stands right before the second of two names.

        Small words may follow it. The "no" of "a la cocina no al despacho" may as well take back
        the first.
        """
        said = self._contrasts.places(tokens).intersection(between)
        behind = range(max(said, default=between.stop) + 1, between.stop)
        return bool(said) and self._filling.places(tokens).issuperset(behind)

    def _denies_behind(self, tokens: Words, between: range) -> bool:
        """True if a "not" between two names denies the second: "a la cocina, no al despacho"."""
        said = self._denials.places(tokens).intersection(between)
        marks = {at for at in between if is_mark(tokens[at])}
        parted = marks | self._joints.places(tokens)
        first = min(said, default=0)
        opens = not parted.isdisjoint(range(between.start, first + 1))
        return bool(said) and opens and max(said) > max(marks, default=-1)

    def _denies_both(self, tokens: Words, between: range, denied: frozenset[int]) -> bool:
        """True if what is between two names denies the second as the first: "not to A and to B"."""
        marks = [at for at in between if is_mark(tokens[at])]
        again = denied.intersection(range(max(marks, default=between.start - 1) + 1, between.stop))
        pair = self._lexicon.book.hearing.pair
        follows = self._lexicon.book.hearing.denials_follow
        return (bool(again) and not follows) or any(tokens[at] == pair for at in between)

    def _corrected(self, tokens: Words, numbers: Sequence[Number]) -> list[Number]:
        """The numbers that the next one does not correct: "90 degrees, make that 60"."""
        correcting = self._correcting(tokens)
        taken_back = {
            first.start
            for first, second in itertools.pairwise(numbers)
            if correcting & set(range(first.end, second.start))
        }
        return [one for one in numbers if one.start not in taken_back]

    def _parts(self, sentence: Clauses) -> tuple[ClauseReading, ...]:
        """The best split of a sentence into calls, by dynamic programming over its borders."""
        borders = self._borders(sentence.tokens)
        best: list[tuple[float, tuple[ClauseReading, ...]] | None] = [None] * len(borders)
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
        return sorted(borders | self._opening.starts(tokens))

    def _meant(self, parts: tuple[ClauseReading, ...]) -> tuple[ClauseReading, ...]:
        """The parts without weak ones, which a stray word beside a real order speaks for."""
        if len(parts) < 2:
            return parts
        skills = self._lexicon.skills
        strong = [
            one
            for one in parts
            if one.grounded or skills[one.call.skill].moves or one.support >= _BESIDE
        ]
        return tuple(strong) or parts

    def _takes_back(
        self, parts: tuple[ClauseReading, ...], tokens: Words, values: Collection[int]
    ) -> bool:
        """True if the first of two motions is taken back: "not left, right", "left, no, right".

        A correction before the last of its `values` takes back another value: "blue, no, red". A
        denial from there on, without a mark behind it, denies the second: "izquierda, no a la
        derecha", "left, sorry, not right".
        """
        if len(parts) != 2 or not all(self._lexicon.skills[p.call.skill].drives for p in parts):
            return False
        first, second = parts
        denied = self._negations.places(tokens) - self._courtesies.places(tokens)
        opening = range(first.start, min(first.start + 2, first.end))
        alone = bool(denied) and denied <= set(range(first.start, first.end))
        if alone and denied.intersection(opening) and is_mark(tokens[second.start]):
            return first.call.skill != second.call.skill
        said = max((at for at in values if first.start <= at < first.end), default=first.start)
        between = range(said + 1, second.start + 2)
        starts = self._corrections.starts(tokens) & self._correcting(tokens)
        corrected = starts.intersection(between)
        denying = denied | self._denials.places(tokens)
        behind = range(min(corrected, default=second.end), second.end - 1)
        if any(at in denying and not is_mark(tokens[at + 1]) for at in behind):
            return False
        return bool(corrected) and first.call.skill != second.call.skill

    def _ordered(
        self, parts: tuple[ClauseReading, ...], tokens: Words
    ) -> tuple[ClauseReading, ...]:
        """The parts in the order of doing: "before A, B" and "A, but first B" mean B, then A."""
        if len(parts) != 2:
            return parts
        second = parts[1]
        first_words = self._reversal.starts(tokens)
        opening = range(parts[0].start, min(parts[0].start + 2, len(tokens)))
        if first_words & set(opening):
            return second, parts[0]
        return parts


def _as_written(names: Sequence[Name], tokens: Words, written: Words) -> Iterator[Name]:
    """The names, those from a corrected spelling marked as guessed."""
    for one in names:
        said = set(tokens[one.start : one.end]) <= set(written)
        yield one if said else replace(one, guessed=True)


def _once(parts: tuple[ClauseReading, ...]) -> tuple[ClauseReading, ...]:
    """The parts without a repetition of the call before: "the lab, they are in the lab"."""
    kept = [
        part
        for index, part in enumerate(parts)
        if not (index and part.call == parts[index - 1].call and not _counts(part.call))
    ]
    return tuple(kept)


def _counts(call: Call) -> bool:
    return any(isinstance(value, float) for value in call.arguments.values())


def _gaps(parts: Sequence[ClauseReading], size: int) -> Iterator[tuple[int, int]]:
    at = 0
    for part in parts:
        yield at, part.start
        at = part.end
    yield at, size
