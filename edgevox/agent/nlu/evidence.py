"""What speaks for and against a reading being an order, as numbers that a head weighs."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from edgevox.agent.nlu.clauses import ClauseReading
from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.readings import Reading
from edgevox.agent.nlu.tokens import Words, is_mark, is_number
from edgevox.agent.phrase_file import ENGLISH

_QUESTION_MARKS = "?\N{FULLWIDTH QUESTION MARK}\N{ARABIC QUESTION MARK}"
_MOST_DOUBTS = 4
_MOST_NAMED = 2
_SPEAKS = 0.4
"""What a word weighs at least that opens an order."""
_SAYS_SO = 0.6
"""What the words of a skill weigh at least that say that it is wanted, where nothing else does.

In English, of which the judge was shown ten times as many sentences, any of them say so.
"""


def evidence(reading: Reading, lexicon: Lexicon, text: str) -> Mapping[str, float]:
    """The numbers by their names, in one order."""
    parts, tokens = reading.parts, reading.tokens
    words = lexicon.function_words
    size = max(1, sum(not is_mark(token) for token in tokens))
    asking = bool(lexicon.index(words.asking).starts(tokens))
    wishing = bool(lexicon.index(words.wishes).starts(tokens))
    said = _SaidWords(lexicon, tokens, reading.courteous)
    asks = any(mark in text for mark in _QUESTION_MARKS)
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
    """Whether a word of this language denies something in a sentence that was read in another."""
    return bool(lexicon.index(lexicon.function_words.negations).starts(lexicon.tokenize(text)))


def is_doubted(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """Whether no word says that it is wanted, or may not say so.

    Something is told of what is named: "the kitchen's over there". A number goes on in a word that
    nobody knows, or nothing joins two orders, one of which may have been taken back: "forward, back
    one metre".
    """
    joints = lexicon.index(tuple(lexicon.book.hearing.joints))
    if len(reading.parts) > 1 and not joints.starts(reading.tokens):
        return True
    wanted = any(facts[one] for one in ("urged", "asking", "wishing", "corrected"))
    if _is_told_of(reading.tokens, lexicon, wanted):
        return True
    pairs = itertools.pairwise(reading.tokens)
    if any(is_number(a) and b.isalpha() and not lexicon.knows(b) for a, b in pairs):
        return True
    return is_unsupported(reading, facts, lexicon) and not wanted


def _is_told_of(tokens: Words, lexicon: Lexicon, wanted: bool) -> bool:
    """Whether a name stands beside a copula: "the dock is free", "over there's the dock".

    Before it may stand what it is where that is `wanted`: "your next waypoint is the dock".
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
    """Whether the words of the skills alone do not say that they are wanted."""
    if lexicon.book.code == ENGLISH:
        return facts["least_support"] <= 0
    return min(part.told for part in reading.parts) < _SAYS_SO


@dataclass(frozen=True, slots=True)
class _SaidWords:
    """What of the tables of small words a sentence holds, but for its courtesies."""

    lexicon: Lexicon
    tokens: Sequence[str]
    courteous: frozenset[int]

    def count(self, phrases: tuple[str, ...], parts: Sequence[ClauseReading] | None = None) -> int:
        """How many of these it holds, anywhere or within these parts."""
        return len(
            {
                one
                for at, one in self._found(phrases)
                if parts is None or any(part.start <= at < part.end for part in parts)
            }
        )

    def opens(self, phrases: tuple[str, ...]) -> bool:
        """Whether it, or a part of it after a mark, begins with one of these."""
        starts = {0, *(at + 1 for at, token in enumerate(self.tokens) if is_mark(token))}
        return any(at in starts for at, _ in self._found(phrases))

    def _found(self, phrases: tuple[str, ...]) -> Iterator[tuple[int, Words]]:
        for at, one in self.lexicon.index(phrases).find(self.tokens):
            if not self.courteous.issuperset(range(at, at + len(one))):
                yield at, one


def _addresses_another(reading: Reading, lexicon: Lexicon) -> bool:
    """Whether one or two unknown words stand alone between marks: "Lucy, go to the office"."""
    clauses: list[list[str]] = [[]]
    for token in reading.tokens:
        if is_mark(token):
            clauses.append([])
        else:
            clauses[-1].append(token)
    return len(clauses) > 1 and any(
        one and len(one) <= _MOST_NAMED and not any(map(lexicon.knows, one))
        for one in (clauses[0], clauses[-1])
    )


def _is_imperative(reading: Reading, lexicon: Lexicon) -> bool:
    """Whether each part begins, but for courtesies, with a word that speaks for its skill."""
    words = set(lexicon.function_words.fillers)
    for part in reading.parts:
        weights = lexicon.words[part.call.skill].weights
        opening = next(
            (
                token
                for at, token in enumerate(reading.tokens[part.start : part.end], part.start)
                if not is_mark(token)
                and at not in reading.courteous
                and (weights.get(token, 0.0) >= _SPEAKS or token not in words)
            ),
            "",
        )
        if weights.get(opening, 0.0) < _SPEAKS:
            return False
    return True
