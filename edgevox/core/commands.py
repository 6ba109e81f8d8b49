"""Commands to EdgeVox, from a person, a ROS 2 node or a script, and the ways by which they come."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

from edgevox.core.events import Cause


class Way(StrEnum):
    """A way in. A page in the browser has one for each role, and so has speech: a guest is a person
    whose voice is not enrolled, where voice prints are in use.
    """

    VOICE = "voice"
    VOICE_GUEST = "voice_guest"
    TYPED = "typed"
    TEXT_INPUT = "text_input"
    COMMAND = "command"
    ACTION = "action"
    GOAL_POSE = "goal_pose"
    CMD_VEL = "cmd_vel"
    CONSOLE_VIEWER = "console_viewer"
    CONSOLE_OPERATOR = "console_operator"

    @property
    def attended(self) -> bool:
        """True if the way has a person whom the robot can ask back, in words."""
        return self not in _UNATTENDED

    @property
    def spoken(self) -> bool:
        """True if the words were heard, and so may have been misheard."""
        return self in _SPOKEN


_SPOKEN = frozenset({Way.VOICE, Way.VOICE_GUEST})
_UNATTENDED = frozenset({Way.COMMAND, Way.ACTION, Way.GOAL_POSE, Way.CMD_VEL})


@dataclass(frozen=True, slots=True)
class TextInput:
    """Words for the agent, as if they had been spoken and transcribed."""

    text: str
    """The words."""
    way: Way = Way.TEXT_INPUT
    """The way in which the words came."""


@dataclass(frozen=True, slots=True)
class Transcribing:
    """An utterance is being transcribed: its words follow, as `Heard`."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """Words that may have been said instead of the transcript."""

    text: str
    """The words."""
    share: float
    """Probability of these words among all hypotheses, from 0 to 1."""
    confidence: float
    """Mean probability of the words' tokens, from 0 to 1."""


def as_hypotheses(text: str, confidence: float, others: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The transcript, with the share that the others leave, and the others."""
    share = max(0.0, 1.0 - sum(one.share for one in others))
    return [Hypothesis(text, share, confidence), *others]


Rate = Callable[[Sequence[str]], Sequence[float]]
"""Returns how likely each of these texts was said in a sound: the sum of its tokens' log
probabilities, in nats. May be called from any thread, and takes some 15 ms for a text."""


@dataclass(frozen=True, slots=True)
class Heard:
    """A spoken utterance and its transcript."""

    text: str
    """The transcript; empty if the sound held no words."""
    ended_s: float
    """The clock's time of the last voiced sample."""
    stt_s: float = 0.0
    """Seconds that speech recognition took."""
    way: Way = Way.VOICE
    """The way in which the words came."""
    spotted: bool = False
    """True if the spotter heard a stop word in the sound; the robot has stopped for it already."""
    confidence: float = 1.0
    """Confidence that the transcript is right, from 0 to 1."""
    others: tuple[Hypothesis, ...] = ()
    """Other words that may have been said, the likeliest first."""
    began_s: float | None = None
    """The clock's time of the first voiced sample; None counts as `ended_s`."""
    over: bool = False
    """True if the robot holds its answer for these words, since `SpokenOver`."""
    rate: Rate | None = field(default=None, compare=False, repr=False)
    """Rates other texts by the sound; None where the transcript is sure, or nothing can."""

    @property
    def first_s(self) -> float:
        """The clock's time of the first voiced sample, or of the last where that is not known."""
        return self.ended_s if self.began_s is None else self.began_s


@dataclass(frozen=True, slots=True)
class StopSpotted:
    """The spotter heard the sound of a stop word, before any transcript exists."""

    at_s: float
    """The clock's time when the sound ended."""
    word: str
    """The stop word that the sound is most like."""
    goes_on: bool = False
    """True if the utterance is not over. A `Heard` with `spotted` then follows, and the robot waits
    for it before it says that it stopped, so that it does not talk over the person."""


@dataclass(frozen=True, slots=True)
class SpokenOver:
    """A person began to speak while the robot speaks, who may only say "mm-hm".

    The robot holds its answer. A `Heard` with `over` follows, whose words tell whether it goes on,
    or an `Interrupt`.
    """


@dataclass(frozen=True, slots=True)
class SpokenOn:
    """The person speaks on after a `Heard`: its words were not all, and come again as a whole."""

    ended_s: float
    """The `ended_s` of that `Heard`."""


@dataclass(frozen=True, slots=True)
class Speak:
    """Say this text aloud as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Interrupt:
    """Stop talking, stop thinking, and stop moving unless `motion` is False."""

    reason: str = "interrupted"
    """The reason, as an English sentence or word."""
    motion: bool = True
    """False to keep moving: speaking over the robot only silences it."""
    cause: Cause = Cause.PROGRAM
    """The source of the interruption."""


@dataclass(frozen=True, slots=True)
class SetLanguage:
    """Change the language."""

    code: str
    """ISO 639-1 code."""


@dataclass(frozen=True, slots=True)
class SetVoice:
    """Change the text-to-speech voice."""

    name: str


@dataclass(frozen=True, slots=True)
class SetMuted:
    """Mute or unmute the microphone."""

    muted: bool


@dataclass(frozen=True, slots=True)
class Reset:
    """Forget the conversation and stop what it started."""


@dataclass(frozen=True, slots=True)
class RunSkill:
    """Run one skill, without any language understanding."""

    name: str
    """The skill's name."""
    arguments: Mapping[str, Any]
    """Its keyword arguments."""
    way: Way = Way.COMMAND
    """The way in which the request came."""


@dataclass(frozen=True, slots=True)
class CancelProgram:
    """Forget a program that waits or runs."""

    program_id: str = ""
    """The program's id; empty for all programs."""


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
    | SpokenOver
    | Speak
    | Interrupt
    | Reset
    | RunSkill
    | CancelProgram
)
"""Commands that the conversation takes."""
Command = ConversationCommand | SetLanguage | SetVoice | SetMuted | Query


class Submit(Protocol):
    """Takes commands from any thread and returns at once, before they are carried out."""

    def __call__(self, command: Command, mark: int | None = None) -> None:
        """Take a command. `mark` is the interlock's mark when it was received, now by default.

        Raises `InvalidValue` for a command that cannot be honoured.
        """
