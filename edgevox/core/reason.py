"""Why something was not done, as data: for programs a code, for people a sentence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Named:
    """What a reason is about, with what it is called in some languages, by code."""

    text: str
    names: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.names.get("en", self.text)


@dataclass(frozen=True, slots=True)
class Reason:
    """`text` is English, a sentence that a person may hear; an empty one is no reason.

    `code` is what the phrasebooks of all languages know it by, and `values` are what it is about:
    names, `Named`, tuples of names, numbers as they are said, other reasons. Without a code it is
    somebody's own sentence, which is said as it is in every language. `sentences` are its own by
    language, of one that no phrasebook knows.
    """

    text: str
    code: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    sentences: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.text)

    def __str__(self) -> str:
        return self.text


NO_REASON = Reason("")


def in_english(value: Any) -> str:
    """What a reason is about, as a word in a sentence."""
    return ", ".join(value) if isinstance(value, tuple) else str(value)
