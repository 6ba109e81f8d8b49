"""Text from outside, made safe to handle: bounded, on one line, without control characters."""

import unicodedata

MAX_CHARACTERS = 2000
"""The longest utterance that is taken."""

_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"  # what a decoder leaves where bytes were not UTF-8


def clean(text: str) -> str:
    """One line without control characters and undecodable bytes; looks at a bounded part only."""
    bounded = text[: 2 * MAX_CHARACTERS]
    kept = (" " if c == _REPLACEMENT or unicodedata.category(c)[0] == "C" else c for c in bounded)
    return " ".join("".join(kept).split())
