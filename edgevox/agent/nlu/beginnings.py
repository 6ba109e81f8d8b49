"""What sentences of a template may begin with: one that begins otherwise need not be tried.

Most templates begin with a verb, and most sentences with another one. To try all of a template
that has many forms takes longer than all else that is done to a sentence.
"""

from collections.abc import Mapping

from hassil.expression import Alternative, Expression, RuleReference, Sentence, Sequence, TextChunk
from hassil.util import normalize_for_matching

ANY = ""
"""What every sentence begins with."""


def said(text: str) -> str:
    """A sentence as its beginning is compared: as hassil compares it, and in lower case."""
    if text.isascii() and text.replace(" ", "").isalnum():  # with nothing to take away
        return text.strip().casefold()
    return str(normalize_for_matching(text).text).casefold()


def beginnings(template: Sentence, rules: Mapping[str, Sentence]) -> frozenset[str]:
    """First words or parts of them, in lower case: one of them begins each of its sentences."""
    found, empty = _begins(template.expression, rules)
    return frozenset({ANY}) if empty or ANY in found else found


def _begins(part: Expression, rules: Mapping[str, Sentence]) -> tuple[frozenset[str], bool]:
    """What this part may begin with, and whether nothing at all may stand for it."""
    match part:
        case TextChunk():
            words = part.text.split(maxsplit=1)
            return frozenset(map(_compared, words[:1])), not words
        case RuleReference(rule_name=name) if name in rules:
            return _begins(rules[name].expression, rules)
        case Alternative():
            some = [_begins(item, rules) for item in part.items]
            return frozenset().union(*(one for one, _ in some)), any(empty for _, empty in some)
        case Sequence():
            found: frozenset[str] = frozenset()
            for item in part.items:
                more, empty = _begins(item, rules)
                found |= more
                if not empty:
                    return found, False
            return found, True
    return frozenset({ANY}), False  # a word of a list, or any


def _compared(word: str) -> str:
    return word.casefold() if word[0].isalnum() else ANY
