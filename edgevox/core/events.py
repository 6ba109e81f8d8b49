"""Events on the bus. Everything that EdgeVox shows, on ROS 2 or a terminal, is one of these."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from edgevox.core.agent_events import AgentEvent


class State(StrEnum):
    """States of the conversation, as the topic `state` reports them."""

    LISTENING = "listening"
    TRANSCRIBING = "transcribing"
    THINKING = "thinking"
    SPEAKING = "speaking"
    INTERRUPTED = "interrupted"


class Outcome(StrEnum):
    """Outcomes of a turn that words asked for."""

    ANSWERED = "answered"
    ACTED = "acted"
    ASKED = "asked"
    REFUSED = "refused"
    NOT_UNDERSTOOD = "not_understood"
    INTERRUPTED = "interrupted"
    FAILED = "failed"


class Cause(StrEnum):
    """Sources of an interruption."""

    TOPIC = "topic"
    BARGE_IN = "barge_in"
    WAKE_WORD = "wake_word"
    STOP_WORD = "stop_word"
    STOP_SPOTTER = "stop_spotter"
    TERMINAL = "terminal"
    RESET = "reset"
    PROGRAM = "program"


@dataclass(frozen=True, slots=True)
class Transcribed:
    """Words that the person said or typed, as text."""

    text: str
    """The words."""
    turn: int = 0
    """Number of the turn that they start; 0 if they start none."""
    confidence: float | None = None
    """Confidence that the transcript is right, from 0 to 1; None for words that were not spoken."""


@dataclass(frozen=True, slots=True)
class Decided:
    """The meaning found in the words of a turn, before it is done, asked about or refused."""

    calls: tuple[tuple[str, Mapping[str, Any]], ...]
    """Names of skills with their arguments."""
    stage: str
    """The stage that understood the words: ``template`` or ``reading``."""
    confidence: float
    """Confidence in the meaning, from 0 to 1."""
    turn: int
    """Number of the turn."""


@dataclass(frozen=True, slots=True)
class TokenGenerated:
    """A piece of an answer, as soon as it exists."""

    text: str
    turn: int = 0


@dataclass(frozen=True, slots=True)
class SentenceReady:
    """A whole sentence of an answer, as it goes to text-to-speech."""

    text: str
    turn: int = 0


@dataclass(frozen=True, slots=True)
class Responded:
    """The full text of an answer."""

    text: str
    """The answer; if it was cut, only the part that was said."""
    turn: int = 0
    """Number of the turn."""
    cut: bool = False
    """True if the answer was interrupted before its end."""
    detail: str = ""
    """Text that is written beside the answer and too long to say, such as a list."""

    @property
    def written(self) -> str:
        """The answer and its detail, for reading."""
        return f"{self.text} {self.detail}".strip()


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The conversation went into another state."""

    state: State
    turn: int = 0


@dataclass(frozen=True, slots=True)
class AudioLevel:
    """Loudness of the microphone, root mean square, 0 to 1."""

    level: float


@dataclass(frozen=True, slots=True)
class WakeWordHeard:
    """The wake word was heard, e.g. ``hey jarvis``."""

    phrase: str


@dataclass(frozen=True, slots=True)
class TurnMeasured:
    """Seconds that the stages of one turn took; 0 for a stage that the turn did not need."""

    stt: float
    """Seconds of speech recognition."""
    llm: float
    """Seconds that a language model worked."""
    tts: float
    """Seconds of speech synthesis."""
    ttfs: float
    """Seconds from the end of the input to the first part of the answer that a person notices."""
    total: float
    """Seconds from the end of the input to the end of the turn."""
    turn: int = 0
    """Number of the turn."""


@dataclass(frozen=True, slots=True)
class RobotState:
    """A snapshot of the body, JSON-ready: pose, velocity, goal, battery where it has one."""

    data: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class PictureTaken:
    """The robot took a picture, because it was asked to."""

    png: bytes
    """The picture as a PNG file."""
    file: str
    """The file that keeps it; empty where it cannot be kept."""


@dataclass(frozen=True, slots=True)
class ControlChanged:
    """A control that can change at run time changed: `language`, `voice`, `muted` or `confirm`."""

    name: str
    value: str | bool


@dataclass(frozen=True, slots=True)
class Answered:
    """The answer to a `Query`: JSON-ready, without the key ``query``."""

    query: str
    data: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class TurnEnded:
    """A turn is over: the robot says nothing more for it, though its goals may still run."""

    turn: int
    """Number of the turn."""
    outcome: Outcome | None = None
    """The outcome; None for a turn that no words asked for."""
    tokens: int = 0
    """Number of tokens that a language model generated for it."""


@dataclass(frozen=True, slots=True)
class Interrupted:
    """An interruption was asked for, whether or not anything ran; most also halt the robot."""

    cause: Cause


Event = (
    Transcribed
    | Decided
    | TokenGenerated
    | SentenceReady
    | Responded
    | StateChanged
    | AudioLevel
    | WakeWordHeard
    | TurnMeasured
    | AgentEvent
    | RobotState
    | PictureTaken
    | ControlChanged
    | Answered
    | TurnEnded
    | Interrupted
)
