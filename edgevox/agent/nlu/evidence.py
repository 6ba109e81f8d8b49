"""What speaks for and against a reading being an order, as numbers that a head weighs."""

import math
from collections.abc import Mapping, Sequence

from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.readings import Reading
from edgevox.agent.nlu.tokens import find, is_mark

_QUESTION_MARKS = "?\N{FULLWIDTH QUESTION MARK}\N{ARABIC QUESTION MARK}"
_MOST_DOUBTS = 4


def evidence(reading: Reading, lexicon: Lexicon, text: str) -> Mapping[str, float]:
    """The numbers by their names, in one order."""
    parts, tokens = reading.parts, reading.tokens
    words = lexicon.function_words
    size = max(1, sum(not is_mark(token) for token in tokens))
    asking = _count(lexicon, tokens, words.asking) > 0
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
        "reports": _count(lexicon, tokens, words.reports) > 0,
        "conditions": min(_count(lexicon, tokens, words.conditions), 2),
        "doubts": min(_count(lexicon, tokens, words.doubts), _MOST_DOUBTS),
        "asks": asks and not asking,
        "opens_as_question": (_opens(lexicon, tokens, words.questions) and not asking)
        or (asks and _count(lexicon, tokens, words.questions) > 0),
        "doubted_first": _opens(lexicon, tokens, (*words.doubts, *words.conditions)),
        "asking": asking,
        "moves": all(lexicon.skills[part.call.skill].moves for part in parts),
        "elliptic": any(part.support <= 0 for part in parts),
        "unspaced": not lexicon.book.hearing.spaced,
    }


def _count(lexicon: Lexicon, tokens: Sequence[str], phrases: Sequence[str]) -> int:
    return sum(bool(find(tokens, lexicon.tokenize(phrase))) for phrase in phrases)


def _opens(lexicon: Lexicon, tokens: Sequence[str], phrases: Sequence[str]) -> bool:
    """Whether the sentence, or a part of it after a mark, begins with one of these."""
    starts = {0, *(at + 1 for at, token in enumerate(tokens) if is_mark(token))}
    return any(starts.intersection(find(tokens, lexicon.tokenize(one))) for one in phrases)
