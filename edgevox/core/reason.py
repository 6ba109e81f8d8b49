"""Reasons of refusals and failures as data: a code for programs, a sentence for people."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Named:
    """A thing that a reason is about, with its names by language code."""

    text: str
    names: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.names.get("en", self.text)


@dataclass(frozen=True, slots=True)
class Reason:
    """A reason of a refusal or failure; false if its text is empty."""

    text: str
    """An English sentence that a person may hear; empty for no reason."""
    code: str = ""
    """The key of the sentence in the phrasebooks of all languages. Without a code, `text` is said
    as it is in every language."""
    values: Mapping[str, Any] = field(default_factory=dict)
    """Values for the sentence: names, `Named`, tuples of names, spoken numbers, other reasons."""
    sentences: Mapping[str, str] = field(default_factory=dict)
    """Own sentences by language code, for a code that no phrasebook knows."""
    is_sentence: bool = False
    """True if it says by itself that something failed: nothing stands before it."""

    def __bool__(self) -> bool:
        return bool(self.text)

    def __str__(self) -> str:
        return self.text


NO_REASON = Reason("")


def in_english(value: Any) -> str:
    """A value of a reason as words in an English sentence."""
    return ", ".join(value) if isinstance(value, tuple) else str(value)
