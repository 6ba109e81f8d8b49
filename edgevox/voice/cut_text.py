"""What was heard of a sentence that was cut."""

import re

_WORD_END = re.compile(r"\S(?=\s|$)")


def cut_text(sentence: str, share: float, *, spaced: bool = True) -> str:
    """The beginning of a sentence, up to the last word that was whole after `share` of its sound.

    `share` is 0 to 1. Letters stand for time: a word is whole when the share reaches its last
    letter. Without `spaced` words there are no boundaries to be seen, and it is cut at a character.
    """
    if share >= 1.0:
        return sentence
    reached = int(max(0.0, share) * len(sentence) + 1e-9)
    if not spaced:
        return sentence[:reached].rstrip()
    ends = [match.end() for match in _WORD_END.finditer(sentence) if match.end() <= reached]
    return sentence[: ends[-1]] if ends else ""
