"""What waits for the conversation's thread: what somebody asked, and errands of its own."""

from dataclasses import dataclass

from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.text import MAX_CHARACTERS, clean


@dataclass(frozen=True, slots=True)
class Announce:
    """Something to say that nobody asked for now: a goal ended, the robot stopped."""

    text: str


@dataclass(frozen=True, slots=True)
class Forget:
    """Forget what was said, between turns."""


@dataclass(frozen=True, slots=True)
class Settle:
    """Say that the conversation listens again, after a stop that cut no turn."""


@dataclass(frozen=True, slots=True)
class Language:
    """Understand another language, between turns."""

    code: str


@dataclass(frozen=True, slots=True)
class TooLong:
    """Words that are more than is taken, `length` characters; `beginning` is kept of them.

    `asked` says whether they were for the agent, or to be said aloud.
    """

    length: int
    beginning: str
    asked: bool


Item = TextInput | Heard | Speak | RunSkill | TooLong | Announce | Forget | Settle | Language


def bounded(item: Item) -> Item:
    """The same, unless it holds more words than are taken."""
    if not isinstance(item, TextInput | Heard | Speak) or len(item.text) <= MAX_CHARACTERS:
        return item
    beginning = clean(item.text)[:MAX_CHARACTERS]
    return TooLong(len(item.text), beginning, asked=not isinstance(item, Speak))


def asked_in_words(item: Item) -> bool:
    """Whether somebody wants an answer to this."""
    return isinstance(item, TextInput | Heard) or (isinstance(item, TooLong) and item.asked)
