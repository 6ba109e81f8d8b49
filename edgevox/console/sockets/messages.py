"""The messages on the socket `/ws`, both ways.

Those of a page have bounds, all others are refused, and `control` does what they ask for. To pages
go the events of the bus, and to a page that opens the last turns.
"""

import itertools
import json
from collections import OrderedDict
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from edgevox.core.agent_events import AgentEvent, Confirmation, ConfirmationStatus, as_json
from edgevox.core.errors import InvalidValue
from edgevox.core.events import (
    Decided,
    Event,
    Responded,
    SentenceReady,
    StateChanged,
    TokenGenerated,
    Transcribed,
    TurnEnded,
)
from edgevox.core.files.validation import dotted, explain

PROTOCOL = 1
MOST_BYTES = 64 * 1024
"""The most bytes of one message, either way on `/ws`."""

Needs = Literal["session", "operator", "lease"]
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_Metres = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class PageMessage(BaseModel):
    """A message of a page; the answer names its `id`. `needs` is the sender's required right."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
    needs: ClassVar[Needs] = "lease"

    id: int = Field(ge=0, le=1 << 53)


class Text(PageMessage):
    """Words for the robot."""

    type: Literal["text"]
    text: str = Field(min_length=1, max_length=4000)


class YesOrNo(PageMessage):
    """Yes or no to what it asked."""

    type: Literal["answer"]
    yes: bool


class CallSkill(PageMessage):
    """A call of a skill, with its arguments by name."""

    type: Literal["skill"]
    name: _Name
    arguments: dict[str, Any] = {}


class GoTo(PageMessage):
    """Go to this point; metres, map frame."""

    type: Literal["goto"]
    x: _Metres
    y: _Metres


class NamePlace(PageMessage):
    """Remember this point by a name; metres, map frame."""

    type: Literal["name_place"]
    name: _Name
    x: _Metres
    y: _Metres


class Drive(PageMessage):
    """Steer now, in m/s and rad/s; both 0 is a release."""

    type: Literal["drive"]
    linear: float = Field(ge=-100, le=100, allow_inf_nan=False)
    angular: float = Field(ge=-100, le=100, allow_inf_nan=False)

    @property
    def releases(self) -> bool:
        """Whether this lets go of the stick."""
        return self.linear == 0 and self.angular == 0


class Stop(PageMessage):
    """The software stop: taken however it is said, as long as it is one."""

    model_config = ConfigDict(extra="ignore")
    needs: ClassVar[Needs] = "session"

    id: Any = None
    type: Literal["stop"]


class Resume(PageMessage):
    """Motion is allowed again."""

    type: Literal["resume"]


class ChangeLease(PageMessage):
    """A change of the lease: take it if it is free, give it away, ask for it, ask no longer."""

    needs: ClassVar[Needs] = "operator"
    type: Literal["lease"]
    action: Literal["take", "give", "request", "withdraw"]
    to: str | None = Field(None, max_length=64)


class SetControl(PageMessage):
    """Another language, voice, muted or confirm."""

    type: Literal["set"]
    name: Literal["language", "voice", "muted", "confirm"]
    value: bool | Annotated[str, Field(max_length=200)]


class Ping(PageMessage):
    """Is the robot there? `t` comes back as it is."""

    needs: ClassVar[Needs] = "session"
    type: Literal["ping"]
    t: float


class Look(PageMessage):
    """The parts of the robot that the page shows now; it gets no others."""

    needs: ClassVar[Needs] = "session"
    type: Literal["look"]
    what: list[Literal["live", "picture", "status", "log"]] = Field(max_length=8)


class Record(PageMessage):
    """Begin or end a recording."""

    type: Literal["record"]
    action: Literal["start", "stop"]


class DeleteRecording(PageMessage):
    """Remove a recording, by the name of its file."""

    type: Literal["delete_recording"]
    name: _Name


Message = (
    Text
    | YesOrNo
    | CallSkill
    | GoTo
    | NamePlace
    | Drive
    | Stop
    | Resume
    | ChangeLease
    | SetControl
    | Ping
    | Look
    | Record
    | DeleteRecording
)
_ADAPTER: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="type")])


def read(text: str) -> Message:
    """Read a page's message. Raises `InvalidValue`, naming the field that is wrong."""
    try:
        return _ADAPTER.validate_json(text)
    except ValidationError as error:
        raise explain(error, lambda place: dotted(place[1:]) or "message") from None
    except RecursionError:
        raise InvalidValue("message", text, "less deep") from None


Told = Transcribed | Decided | TokenGenerated | SentenceReady | Responded | StateChanged | TurnEnded
"""The events of a conversation that pages get."""
Shown = Told | AgentEvent
"""All events of the bus that pages get."""


def messages_of(event: Event) -> list[dict[str, Any]]:
    """Return the messages for this event."""
    match event:
        case Transcribed(text, turn, confidence):
            return [_talk("heard", turn, text=text, confidence=confidence)]
        case Decided(calls, stage, confidence, turn):
            understood = [{"skill": name, "arguments": dict(given)} for name, given in calls]
            return [_talk("decided", turn, calls=understood, stage=stage, confidence=confidence)]
        case TokenGenerated(text, turn):
            return [_talk("token", turn, text=text)]
        case SentenceReady(text, turn):
            return [_talk("sentence", turn, text=text)]
        case Responded():
            return [
                _talk("response", event.turn, text=event.text, detail=event.detail, cut=event.cut)
            ]
        case StateChanged(state, turn):
            return [_talk("state", turn, state=str(state))]
        case TurnEnded(turn, outcome, tokens):
            ended = str(outcome) if outcome else None
            return [_talk("turn_ended", turn, outcome=ended, stage="model" if tokens else None)]
        case Confirmation():
            return [_asked(event), {**as_json(event), "type": "event"}]
        case _ if isinstance(event, AgentEvent):
            return [{**as_json(event), "type": "event"}]
    return []


def _asked(event: Confirmation) -> dict[str, Any]:
    is_open = event.status is ConfirmationStatus.ASKED
    text, expires_s = event.question, event.expires_s
    return _talk("asked", event.turn, text=text, expires_s=expires_s, goes=event.goes, open=is_open)


def _talk(kind: str, turn: int, **fields: Any) -> dict[str, Any]:
    return {"type": "talk", "kind": kind, "turn": turn, **fields}


MOST_TURNS = 20
MOST_TALK_BYTES = 24 * 1024
"""The most bytes of the last turns in one message; of longer ones only the newest are told."""
_KEPT = ("heard", "decided", "response", "turn_ended", "tool_call")


class LastTurns:
    """The last turns and the open question, as messages. For one thread."""

    def __init__(self) -> None:
        self._turns: OrderedDict[int, list[Mapping[str, Any]]] = OrderedDict()
        self._question: Mapping[str, Any] | None = None
        self._alone = itertools.count(-1, -1)

    def add(self, message: Mapping[str, Any]) -> None:
        """Keep this message, if a page that opens later needs it."""
        kind = message.get("kind")
        if kind == "asked":
            self._question = message if message["open"] else None
        if kind not in _KEPT:
            return
        turn = message.get("turn") or next(self._alone)
        self._turns.setdefault(turn, []).append(message)
        while len(self._turns) > MOST_TURNS:
            self._turns.popitem(last=False)

    def messages(self) -> list[Mapping[str, Any]]:
        """Return the newest turns, in order, and the open question after them."""
        left, told = MOST_TALK_BYTES, []
        for turn in reversed(self._turns.values()):
            left -= len(json.dumps(turn))
            if left < 0:
                break
            told.append(turn)
        question = [self._question] if self._question else []
        return [*itertools.chain.from_iterable(reversed(told)), *question]
