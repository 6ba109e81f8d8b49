"""What speaks for and against a reading being an order, as numbers that a head weighs."""

import itertools
import math
from collections.abc import Mapping, Sequence

from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.readings import Reading
from edgevox.agent.nlu.tokens import find, is_mark, is_number

_QUESTION_MARKS = "?\N{FULLWIDTH QUESTION MARK}\N{ARABIC QUESTION MARK}"
_MOST_DOUBTS = 4
SAYS_SO = 0.6
"""What the words of a skill weigh at least that say that it is wanted, where nothing else does."""


def evidence(reading: Reading, lexicon: Lexicon, text: str) -> Mapping[str, float]:
    """The numbers by their names, in one order."""
    parts, tokens = reading.parts, reading.tokens
    words = lexicon.function_words
    size = max(1, sum(not is_mark(token) for token in tokens))
    asking = _count(lexicon, tokens, words.asking) > 0
    asks = any(mark in text for mark in _QUESTION_MARKS)
    questions = _starts(lexicon, tokens, words.questions) - _covered(lexicon, tokens, words.asking)
    opened = questions & _openings(tokens)
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
        "reports": _count(lexicon, tokens, words.reports) > 0,
        "conditions": min(_count(lexicon, tokens, words.conditions), 2),
        "doubts": min(_count(lexicon, tokens, words.doubts), _MOST_DOUBTS),
        "asks": asks and not asking,
        "opens_as_question": bool(questions if asks else opened and not asking),
        "doubted_first": bool(
            _starts(lexicon, tokens, (*words.doubts, *words.conditions)) & _openings(tokens)
        ),
        "asking": asking,
        "moves": all(lexicon.skills[part.call.skill].moves for part in parts),
        "elliptic": any(part.support <= 0 for part in parts),
        "unspaced": not lexicon.book.hearing.spaced,
    }


def is_denied(text: str, lexicon: Lexicon) -> bool:
    """Whether a word of this language denies something in a sentence that was read in another."""
    return _count(lexicon, lexicon.tokenize(text), lexicon.function_words.negations) > 0


def is_doubted(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """Whether no word says that it is wanted, or a number goes on in a word that nobody knows."""
    pairs = itertools.pairwise(reading.tokens)
    if any(is_number(a) and b.isalpha() and not lexicon.knows(b) for a, b in pairs):
        return True
    words = lexicon.function_words
    if not words.urges or facts["least_support"] >= SAYS_SO:
        return False
    return _count(lexicon, reading.tokens, (*words.urges, *words.asking)) == 0


def _count(lexicon: Lexicon, tokens: Sequence[str], phrases: Sequence[str]) -> int:
    return sum(bool(find(tokens, lexicon.tokenize(phrase))) for phrase in phrases)


def _starts(lexicon: Lexicon, tokens: Sequence[str], phrases: Sequence[str]) -> set[int]:
    """Where one of these begins."""
    return {at for phrase in phrases for at in find(tokens, lexicon.tokenize(phrase))}


def _covered(lexicon: Lexicon, tokens: Sequence[str], phrases: Sequence[str]) -> set[int]:
    """Where a word of one of these stands."""
    sized = [lexicon.tokenize(phrase) for phrase in phrases]
    return {at + i for one in sized for at in find(tokens, one) for i in range(len(one))}


def _openings(tokens: Sequence[str]) -> set[int]:
    """Where the sentence, or a part of it after a mark, begins."""
    return {0, *(at + 1 for at, token in enumerate(tokens) if is_mark(token))}
