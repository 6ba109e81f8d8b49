"""What waits for the conversation's thread: what somebody asked, and errands of its own."""

from dataclasses import dataclass

from edgevox.core.commands import Heard, RunSkill, Speak, TextInput


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


Item = TextInput | Heard | Speak | RunSkill | Announce | Forget | Settle | Language
