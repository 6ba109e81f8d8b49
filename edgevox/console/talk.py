"""The events of the bus as the messages of `/ws`."""

from typing import Any

from edgevox.core.agent_events import AgentEvent, Confirmation, ConfirmationStatus, as_json
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
    return _talk("asked", event.turn, text=event.question, expires_s=event.expires_s, open=is_open)


def _talk(kind: str, turn: int, **fields: Any) -> dict[str, Any]:
    return {"type": "talk", "kind": kind, "turn": turn, **fields}
