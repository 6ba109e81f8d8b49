"""What somebody asks of EdgeVox: a person, a ROS 2 node, a script."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from edgevox.core.events import Cause
from edgevox.core.ways import Way


@dataclass(frozen=True, slots=True)
class TextInput:
    """Words for the agent, as if spoken and understood; `way` is how they came."""

    text: str
    way: Way = Way.TEXT_INPUT


@dataclass(frozen=True, slots=True)
class Transcribing:
    """Somebody spoke and is being understood: words follow, as `Heard`."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """Words that may have been said instead.

    `share` is how likely they are among all that may have been said, `confidence` how likely the
    mean token of them is; both from 0 to 1.
    """

    text: str
    share: float
    confidence: float


@dataclass(frozen=True, slots=True)
class Heard:
    """Words that somebody spoke; empty if there were none in what was heard.

    `began_s` and `ended_s` are the clock's times of the first and the last voiced sample, `stt_s`
    is how long the words took; without `began_s`, it began where it ended. If a
    stop word was `spotted` in it, that has been acted on already. `confidence` is that these are
    the words, from 0 to 1; `others` are what else may have been said, the likeliest first.
    """

    text: str
    ended_s: float
    stt_s: float = 0.0
    way: Way = Way.VOICE
    spotted: bool = False
    confidence: float = 1.0
    others: tuple[Hypothesis, ...] = ()
    began_s: float | None = None


@dataclass(frozen=True, slots=True)
class StopSpotted:
    """The sound of a stop word was heard until `at_s`, the clock's time; its words are not known.

    `word` is the stop word that it sounds most like. With `goes_on` it lies in an utterance that is
    not over: a `Heard` with `spotted` follows, and only then somebody is told, so that nobody is
    talked over.
    """

    at_s: float
    word: str
    goes_on: bool = False


@dataclass(frozen=True, slots=True)
class SpokenOn:
    """Who was `Heard` until `ended_s` speaks on: that was not all, and comes again, whole."""

    ended_s: float


@dataclass(frozen=True, slots=True)
class Speak:
    """Say this text aloud as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Interrupt:
    """Stop talking, stop thinking, and stop moving unless `motion` is False.

    Who speaks over the robot wants to be heard; that alone does not stop a drive.
    """

    reason: str = "interrupted"
    motion: bool = True
    cause: Cause = Cause.PROGRAM


@dataclass(frozen=True, slots=True)
class SetLanguage:
    """Change the language; an ISO 639-1 code."""

    code: str


@dataclass(frozen=True, slots=True)
class SetVoice:
    """Change the text-to-speech voice."""

    name: str


@dataclass(frozen=True, slots=True)
class SetMuted:
    """Stop or start hearing."""

    muted: bool


@dataclass(frozen=True, slots=True)
class Reset:
    """Forget the conversation and stop what it started."""


@dataclass(frozen=True, slots=True)
class RunSkill:
    """Run one skill, by name and with keyword arguments, without any language understanding."""

    name: str
    arguments: Mapping[str, Any]
    way: Way = Way.COMMAND


@dataclass(frozen=True, slots=True)
class CancelProgram:
    """Forget a program that waits or runs, by its id; all of them where that is empty."""

    program_id: str = ""


@dataclass(frozen=True, slots=True)
class Query:
    """Ask for information; answered on the bus."""

    name: str


ConversationCommand = (
    TextInput
    | Transcribing
    | Heard
    | StopSpotted
    | SpokenOn
    | Speak
    | Interrupt
    | Reset
    | RunSkill
    | CancelProgram
)
"""What the conversation takes."""
Command = ConversationCommand | SetLanguage | SetVoice | SetMuted | Query


class Submit(Protocol):
    """Takes commands, from any thread, without waiting for what they ask for."""

    def __call__(self, command: Command, mark: int | None = None) -> None:
        """Take one. `mark` is the interlock's when it was received, now by default.

        Raises `InvalidValue` for one that cannot be honoured.
        """
