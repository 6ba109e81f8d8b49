"""The evidence about a reading: signs for and against it, and what makes it doubtful."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.clauses import ClauseReading
from edgevox.agent.nlu.lexicon import Lexicon, Words, is_mark, is_number
from edgevox.agent.nlu.reading import Reading
from edgevox.agent.nlu.remainder import SPEAKS
from edgevox.agent.phrases.load import ENGLISH

QUESTION_MARKS = "?\N{FULLWIDTH QUESTION MARK}\N{ARABIC QUESTION MARK}"
_MOST_DOUBTS = 4
_MOST_NAMED = 2
_SAYS_SO = 0.6
"""Least weight of a skill's words that alone say that the skill is wanted.

In English any such word is enough: the head was trained on ten times as many English sentences.
"""


def evidence(reading: Reading, lexicon: Lexicon, text: str) -> Mapping[str, float]:
    """The evidence about a reading: numbers by name, in a fixed order."""
    parts, tokens = reading.parts, reading.tokens
    words = lexicon.function_words
    size = max(1, sum(not is_mark(token) for token in tokens))
    asking = bool(lexicon.index(words.asking).starts(tokens))
    wishing = bool(lexicon.index(words.wishes).starts(tokens))
    said = _SaidWords(lexicon, tokens, reading.courteous)
    asks = any(mark in text for mark in QUESTION_MARKS)
    return {
        "strange": reading.strange,
        "strange_inside": max(part.strange for part in parts),
        "strange_alone": max(part.strange * (part.grounded == 0) for part in parts),
        "strange_unfilled": max(part.strange * (part.unfilled > 0) for part in parts),
        "share_strange": reading.strange / size,
        "size": math.log(size),
        "parts": len(parts),
        "least_support": min(part.support for part in parts),
        "support": math.log1p(sum(part.support for part in parts)),
        "margin": min(part.support - part.rival for part in parts),
        "grounded": min(part.grounded for part in parts),
        "nearly": any(part.nearly for part in parts),
        "unitless": any(part.unitless for part in parts),
        "corrected": reading.corrected,
        "denied": reading.denied,
        "reports": said.count(words.reports) > 0,
        "conditions": min(said.count(words.conditions), 2),
        "doubts": min(said.count(words.doubts), _MOST_DOUBTS),
        "doubts_inside": min(said.count(words.doubts, reading.parts), _MOST_DOUBTS),
        "asks": asks and not asking,
        "opens_as_question": (said.opens(words.questions) and not asking)
        or (asks and said.count(words.questions) > 0),
        "doubted_first": said.opens((*words.doubts, *words.conditions)),
        "asking": asking,
        "wishing": wishing,
        "plans": said.count(words.plans) > 0,
        "urged": bool(lexicon.index(words.urges).starts(tokens)),
        "addressed": _addresses_another(reading, lexicon),
        "half_filled": any(part.unfilled > 0 and part.grounded > 0 for part in parts),
        "courteous": len(reading.courteous) > 0,
        "imperative": _is_imperative(reading, lexicon),
        "moves": all(lexicon.skills[part.call.skill].moves for part in parts),
        "elliptic": any(part.support <= 0 for part in parts),
        "unspaced": not lexicon.book.hearing.spaced,
    }


def is_denied(text: str, lexicon: Lexicon) -> bool:
    """True if a word of this language denies something in a sentence read in another language."""
    return bool(lexicon.index(lexicon.function_words.negations).starts(lexicon.tokenize(text)))


def is_doubted(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """True if the sentence may not want what was read.

    It tells something about a name ("the kitchen's over there"), a number goes on in an unknown
    word, nothing joins two orders, one of which may be taken back ("forward, back one metre"), or
    no word says that the skill is wanted.
    """
    joints = lexicon.index(tuple(lexicon.book.hearing.joints))
    if len(reading.parts) > 1 and not joints.starts(reading.tokens):
        return True
    wanted = any(facts[one] for one in ("urged", "asking", "wishing", "corrected"))
    if _is_told_of(reading.tokens, lexicon, wanted) or _names_another_way(reading, lexicon):
        return True
    if _goes_two_ways(reading, lexicon):
        return True
    pairs = itertools.pairwise(reading.tokens)
    if any(is_number(a) and b.isalpha() and not lexicon.knows(b) for a, b in pairs):
        return True
    return is_unsupported(reading, facts, lexicon) and not wanted


def _names_another_way(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a drive to a place has a word of a motion by an amount: "vai indietro in cucina"."""
    skills = lexicon.skills
    ways = [words.weights for name, words in lexicon.words.items() if skills[name].relative]
    return any(
        lexicon.words[part.call.skill].weights.get(token, 0.0) < SPEAKS
        and any(one.get(token, 0.0) >= SPEAKS for one in ways)
        and not lexicon.in_a_name(token)
        for part in reading.parts
        if skills[part.call.skill].choices and skills[part.call.skill].drives
        for at, token in enumerate(reading.tokens[part.start : part.end], part.start)
        if at not in reading.courteous
    )


def _goes_two_ways(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a motion by an amount has, behind a mark, a word of another one alone.

    "Forward, back one metre" may take the first word back.
    """
    moving = {name: one.weights for name, one in lexicon.words.items() if one.skill.relative}
    for part in reading.parts:
        if (own := moving.get(part.call.skill)) is None:
            continue
        said = itertools.dropwhile(
            lambda one: not is_mark(one), reading.tokens[part.start : part.end]
        )
        others = [one for name, one in moving.items() if name != part.call.skill]
        if any(one not in own and any(one in other for other in others) for one in said):
            return True
    return False


def _is_told_of(tokens: Words, lexicon: Lexicon, wanted: bool) -> bool:
    """True if a name stands beside a copula: "the dock is free", "over there's the dock".

    In a `wanted` sentence a name may follow the copula: "your next waypoint is the dock".
    """
    copulas, articles = lexicon.function_words.copulas, lexicon.book.hearing.articles
    for at, one in enumerate(tokens):
        if one not in copulas or lexicon.in_a_name(one):
            continue
        if at and lexicon.in_a_name(tokens[at - 1].removesuffix("'")):
            return True
        after = next((word for word in tokens[at + 1 :] if word not in articles), "")
        if not wanted and lexicon.in_a_name(after):
            return True
    return False


def is_unsupported(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """True if the words of the skills alone do not say that the skills are wanted."""
    if lexicon.book.code == ENGLISH:
        return facts["least_support"] <= 0
    return min(part.told for part in reading.parts) < _SAYS_SO


@dataclass(frozen=True, slots=True)
class _SaidWords:
    """The function words in a sentence, without those inside its courtesies."""

    lexicon: Lexicon
    tokens: Sequence[str]
    courteous: frozenset[int]

    def count(self, phrases: tuple[str, ...], parts: Sequence[ClauseReading] | None = None) -> int:
        """Number of these phrases in the sentence, anywhere or within these parts."""
        return len(
            {
                one
                for at, one in self._found(phrases)
                if parts is None or any(part.start <= at < part.end for part in parts)
            }
        )

    def opens(self, phrases: tuple[str, ...]) -> bool:
        """True if the sentence, or a part after a punctuation mark, begins with such a phrase."""
        starts = {0, *(at + 1 for at, token in enumerate(self.tokens) if is_mark(token))}
        return any(at in starts for at, _ in self._found(phrases))

    def _found(self, phrases: tuple[str, ...]) -> Iterator[tuple[int, Words]]:
        for at, one in self.lexicon.index(phrases).find(self.tokens):
            if not self.courteous.issuperset(range(at, at + len(one))):
                yield at, one


def _addresses_another(reading: Reading, lexicon: Lexicon) -> bool:
    """True if one or two words that are no courtesy stand alone first or last between marks.

    "Lucy, go to the office"; the words of motions are names, too: "Bob".
    """
    clauses: list[list[str]] = [[]]
    for token in reading.tokens:
        if is_mark(token):
            clauses.append([])
        else:
            clauses[-1].append(token)
    if len(clauses) < 2:
        return False
    first, last = clauses[0], clauses[-1]
    small = lexicon.index((*lexicon.function_words.all(), *lexicon.book.hearing.joints))
    return any(
        0 < len(one) <= _MOST_NAMED and not small.places(one) and not any(map(lexicon.knows, one))
        for one in (first, last)
    ) or (lexicon.book.hearing.spaced and not small.places(first) and _is_a_motion(first, lexicon))


def _is_a_motion(words: Sequence[str], lexicon: Lexicon) -> bool:
    """True for a single word that is only a verb of a drive to a place: "bob"."""
    if len(words) != 1 or lexicon.in_a_name(words[0]):
        return False
    weights = [(one.skill, one.weights.get(words[0], 0.0)) for one in lexicon.words.values()]
    aside = any(one.relative and weight >= SPEAKS for one, weight in weights)
    goes = any(one.drives and one.choices and weight > 0 for one, weight in weights)
    return goes and not aside


def _is_imperative(reading: Reading, lexicon: Lexicon) -> bool:
    """True if each part begins, after courtesies, with a word that speaks for its skill."""
    words = set(lexicon.function_words.fillers)
    for part in reading.parts:
        weights = lexicon.words[part.call.skill].weights
        opening = next(
            (
                token
                for at, token in enumerate(reading.tokens[part.start : part.end], part.start)
                if not is_mark(token)
                and at not in reading.courteous
                and (weights.get(token, 0.0) >= SPEAKS or token not in words)
            ),
            "",
        )
        if weights.get(opening, 0.0) < SPEAKS:
            return False
    return True
