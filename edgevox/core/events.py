"""What happened. All that EdgeVox shows, on ROS 2 or a terminal, is one of these on the bus."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from edgevox.core.agent_events import AgentEvent


class State(StrEnum):
    """What the conversation is doing, as the `state` topic says it."""

    LISTENING = "listening"
    TRANSCRIBING = "transcribing"
    THINKING = "thinking"
    SPEAKING = "speaking"
    INTERRUPTED = "interrupted"


class Outcome(StrEnum):
    """What became of a turn that somebody asked for in words."""

    ANSWERED = "answered"
    ACTED = "acted"
    ASKED = "asked"
    REFUSED = "refused"
    NOT_UNDERSTOOD = "not_understood"
    INTERRUPTED = "interrupted"
    FAILED = "failed"


class Cause(StrEnum):
    """Who or what interrupts."""

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
    """What the person said or typed, as text. `turn` is 0 for words that start no turn.

    `confidence` is that these are the words, from 0 to 1; None for what nobody heard.
    """

    text: str
    turn: int = 0
    confidence: float | None = None


@dataclass(frozen=True, slots=True)
class Decided:
    """What the words of a turn were understood as, before it is done, asked about or refused.

    `calls` are skills with their arguments, `stage` is who found that out: ``template``,
    ``reading`` or ``model``. `confidence` is that it is meant, from 0 to 1; None where nothing
    measured that.
    """

    calls: tuple[tuple[str, Mapping[str, Any]], ...]
    stage: str
    confidence: float | None
    turn: int


@dataclass(frozen=True, slots=True)
class TokenGenerated:
    """One piece of an answer, as soon as it exists."""

    text: str
    turn: int = 0


@dataclass(frozen=True, slots=True)
class SentenceReady:
    """One sentence of an answer, whole, as it goes to text-to-speech."""

    text: str
    turn: int = 0


@dataclass(frozen=True, slots=True)
class Responded:
    """The full text of one answer; `cut` if it was interrupted before its end.

    `detail` is what is too long to be said and may be read beside it, such as a list.
    """

    text: str
    turn: int = 0
    cut: bool = False
    detail: str = ""

    @property
    def written(self) -> str:
        """All of it, for whoever reads."""
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
    """Seconds that the stages of one turn took; 0 for a stage it did not need.

    `ttfs` is the time to the first sign of an answer that a person could notice.
    """

    stt: float
    llm: float
    tts: float
    ttfs: float
    total: float
    turn: int = 0


@dataclass(frozen=True, slots=True)
class RobotState:
    """A snapshot of the body, JSON-ready: pose, velocity, goal, battery where it has one."""

    data: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class ControlChanged:
    """`language`, `voice`, `muted` or `confirm`, which can change while it runs, is another now."""

    name: str
    value: str | bool


@dataclass(frozen=True, slots=True)
class Answered:
    """The answer to a `Query`: JSON-ready, without the key ``query``."""

    query: str
    data: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class TurnEnded:
    """A turn is over: nothing more will be said for it, though its goals may still run.

    `outcome` is None for what nobody asked for in words. `tokens` are the pieces that a language
    model generated for it, calls of skills among them.
    """

    turn: int
    outcome: Outcome | None = None
    tokens: int = 0


@dataclass(frozen=True, slots=True)
class Interrupted:
    """Somebody asked for silence, and most for a halt, too, whether or not anything ran."""

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
    | ControlChanged
    | Answered
    | TurnEnded
    | Interrupted
)
