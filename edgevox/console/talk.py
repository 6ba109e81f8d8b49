"""The events of the bus as the messages of `/ws`, and the last turns for a page that opens."""

import itertools
import json
from collections import OrderedDict
from collections.abc import Mapping
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
