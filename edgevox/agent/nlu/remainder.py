"""The remainder of a sentence: words that no call took, as a guard behind every recogniser.

A part of a number, a unit, a time, and a word that delays or denies an order all change the order.
If no value of a reading took such a word, the reading is another order than the spoken one: the
robot then neither does it nor asks about it.
"""

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.clauses import ClauseReading, find_names
from edgevox.agent.nlu.lexicon import Lexicon, Words, is_mark, is_number, plain, words_of
from edgevox.agent.skills import Call
from edgevox.core.languages import STOP_WORDS

SPEAKS = 0.4
"""Least weight of a word that opens an order."""
_ORDINAL = re.compile(r"\d+[a-z]+")
_PER_CENT = "%"
_AT_AN_END = "."
"""Marks the end of a sentence at which a phrase puts an order off: "depois ."."""


def speaks_of_motion(word: str, lexicon: Lexicon) -> bool:
    """True for a word that alone speaks for a motion."""
    return any(
        one.weights.get(word, 0.0) >= SPEAKS
        for name, one in lexicon.words.items()
        if lexicon.skills[name].drives
    )


def may_ask_whether(calls: Sequence[Call], text: str, code: str) -> bool:
    """True if the words may ask about an ability: "can you walk backwards".

    With a value or a courtesy they are an order: "can you walk backwards, please".
    """
    words, said = words_of(code), f" {plain(text)} "
    asked = [plain(one) for one in words.abilities if plain(one) in said]
    if len(calls) != 1 or calls[0].arguments or not asked:
        return False
    for one in asked:
        said = said.replace(one, " ")
    bare = "".join(one if one.isalnum() else " " for one in said)
    return not any(f" {plain(urge)} " in f" {bare} " for urge in STOP_WORDS[code].courtesies)


@dataclass(frozen=True, slots=True)
class _Taken:
    """The words that a reading took from a sentence."""

    units: frozenset[str]
    """Units of the skills' numbers."""
    words: frozenset[str]
    """Other words of the skills' templates."""
    places: frozenset[int]
    """Indices of the units behind numbers."""


def is_left_over(
    tokens: Words,
    lexicon: Lexicon,
    parts: Sequence[ClauseReading] = (),
    *,
    denials: bool = False,
    likely: bool = False,
) -> bool:
    """True if words that change an order stand in none of these parts.

    Without parts, any number is left over. With `denials`, words that deny count as well; a reading
    weighs those itself, since it knows what they deny. The parts are `likely` if more than their
    words speaks for them: they may then begin with a word of another skill.
    """
    taken = _taken(tokens, lexicon, parts)
    spared = _spared(tokens, lexicon)
    return (
        _is_amount_left(tokens, lexicon, taken, spared)
        or _is_put_off(tokens, lexicon, spared)
        or (not parts and any(map(is_number, tokens)))
        or (denials and _is_denied(tokens, lexicon))
        or (not likely and any(_is_anothers(part, tokens, lexicon) for part in parts))
    )


def _taken(tokens: Words, lexicon: Lexicon, parts: Sequence[ClauseReading]) -> _Taken:
    skills = [lexicon.words[part.call.skill] for part in parts]
    units = frozenset(itertools.chain(*(u for one in skills for u in one.units.values())))
    units |= frozenset(itertools.chain(*(one.measures for one in skills)))
    words = frozenset(word for one in skills for word in one.weights if word not in one.shown)
    after = {at + 1 for at, token in enumerate(tokens) if is_number(token)}
    places = {at for at in after if at < len(tokens) and tokens[at] in units}
    return _Taken(units, words - units, frozenset(places))


def _spared(tokens: Words, lexicon: Lexicon) -> dict[int, int]:
    """Indices of tokens in names and in long courtesies, each with the longest length in tokens."""
    spared = {at: len(tokens) for at, token in enumerate(tokens) if lexicon.in_a_name(token)}
    words = lexicon.function_words
    for start, one in lexicon.index((*words.fillers, *words.asking, *words.wishes)).find(tokens):
        for at in range(start, start + len(one)) if len(one) > 1 else ():
            spared[at] = max(spared.get(at, 0), len(one))
    return spared


def _is_amount_left(tokens: Words, lexicon: Lexicon, taken: _Taken, spared: dict[int, int]) -> bool:
    if any(_ORDINAL.fullmatch(t) and not lexicon.knows(t) for t in tokens):
        return True
    if _PER_CENT in tokens and _PER_CENT not in taken.units:
        return True
    for places in _found(tokens, lexicon, lexicon.function_words.amounts, spared):
        words = {tokens[at] for at in places}
        if not (taken.places.issuperset(places) or words <= taken.words):
            return True
    for places in _found(tokens, lexicon, lexicon.function_words.bounds, spared):
        before, after = places.start - 1, places.stop
        ends = before >= 0 and (is_number(tokens[before]) or before in taken.places)
        if ends or (after < len(tokens) and is_number(tokens[after])):
            return True
    if not lexicon.book.hearing.spaced:
        marks = _marks(lexicon)
        if any({one, other} <= marks for one, other in itertools.pairwise(tokens)):
            return True  # an unread number
    return any(_changes(tokens, at, lexicon, taken) for at, t in enumerate(tokens) if is_number(t))


def _marks(lexicon: Lexicon) -> frozenset[str]:
    marks = lexicon.function_words.number_marks
    return frozenset(word for one in marks for word in lexicon.tokenize(one))


def _changes(tokens: Words, at: int, lexicon: Lexicon, taken: _Taken) -> bool:
    """True if a word beside the number at this index continues it: "2 metres five"."""
    marks = _marks(lexicon)
    before = tokens[at - 1] if at else ""
    behind = at + 1 + (at + 1 in taken.places)
    after = tokens[behind] if behind < len(tokens) else ""
    unknown = after.isalpha() and not lexicon.knows(after)
    if unknown and behind == at + 1 and lexicon.book.hearing.spaced:
        return True  # perhaps a unit
    return after in marks or (before in marks and before not in taken.words)


def _is_put_off(tokens: Words, lexicon: Lexicon, spared: dict[int, int]) -> bool:
    phrases = lexicon.function_words.put_off
    ends = [one for one in phrases if one.startswith(_AT_AN_END) or one.endswith(_AT_AN_END)]
    anywhere = tuple(one for one in phrases if one not in ends)
    if next(_found(tokens, lexicon, anywhere, spared), None):
        return True
    said = [token for token in tokens if not is_mark(token)]
    for one in ends:
        words = list(lexicon.tokenize(one.strip(f"{_AT_AN_END} ")))
        opens = one.startswith(_AT_AN_END)
        if (said[: len(words)] if opens else said[-len(words) :]) == words:
            return True
    return False


def is_unsaid(parts: Sequence[ClauseReading], lexicon: Lexicon) -> bool:
    """True if one of these parts rests on a name among unknown words.

    "Light up the kitchen" is no order to go there. A call that changes something for good must be
    said in known words and names alone.
    """
    return any(_is_unsaid(part, lexicon) for part in parts)


def _is_unsaid(part: ClauseReading, lexicon: Lexicon) -> bool:
    unsaid = part.told < SPEAKS
    if lexicon.skills[part.call.skill].lasting:
        return part.guessed or part.strange > 0 or unsaid
    return part.strange > 0 and unsaid


def _is_anothers(part: ClauseReading, tokens: Words, lexicon: Lexicon) -> bool:
    """True if the part begins with a word of another skill: "remember the point x 7, y 2"."""
    small = lexicon.index(lexicon.function_words.all()).places(tokens)
    named = {at for one in find_names(lexicon, tokens) for at in range(one.start, one.end)}
    own = lexicon.words[part.call.skill].weights
    for at in range(part.start, part.end):
        word = tokens[at]
        if at in small or at in named or is_mark(word) or is_number(word):
            continue
        if not lexicon.speaks(word) or word in lexicon.common:
            continue
        others = (one.weights.get(word, 0.0) for one in lexicon.words.values())
        return own.get(word, 0.0) < SPEAKS <= max(others)
    return False


def is_denied_inside(text: str, lexicon: Lexicon) -> bool:
    """True if a negation stands inside a text of a language without spaces: 行かないで."""
    if lexicon.book.hearing.spaced:
        return False
    functions, said = lexicon.function_words, plain(text)
    for one in sorted((*functions.asking, *functions.fillers, *functions.wishes), key=len)[::-1]:
        said = said.replace(plain(one), " ") if len(one) > 1 else said
    return any(plain(one) in said for one in functions.negations if len(one) > 1)


def _is_denied(tokens: Words, lexicon: Lexicon) -> bool:
    return bool(lexicon.index(lexicon.function_words.negations).starts(tokens))


def _found(
    tokens: Words, lexicon: Lexicon, phrases: tuple[str, ...], spared: dict[int, int]
) -> Iterator[range]:
    """Ranges of these phrases, without those inside a name or a longer courtesy."""
    for start, one in lexicon.as_written(phrases).find(tokens):
        places = range(start, start + len(one))
        if not all(spared.get(at, 0) > len(one) for at in places):
            yield places
