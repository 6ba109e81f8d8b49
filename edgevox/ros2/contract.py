"""The contract as data: which event goes out on which topic, which topic comes in as which command.

Names are relative to the node's namespace. Every row here is a ``std_msgs/msg/String``.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any

from edgevox.core.commands import Interrupt, Reset, TextInput
from edgevox.core.errors import InvalidValue
from edgevox.core.events import (
    AgentEvent,
    Responded,
    RobotState,
    SentenceReady,
    StateChanged,
    TokenGenerated,
    Transcribed,
    TurnMeasured,
)

Incoming = TextInput | Interrupt | Reset
"""The commands that come in over ROS 2."""

NODE_NAME = "edgevox"
DEFAULT_NAMESPACE = "/edgevox"


@dataclass(frozen=True, slots=True)
class QosSpec:
    """A quality of service, in ROS 2's own words."""

    reliable: bool
    transient_local: bool
    depth: int


class Qos(Enum):
    """The three qualities of service that the contract knows."""

    STATE = QosSpec(reliable=True, transient_local=True, depth=1)
    SENSOR = QosSpec(reliable=False, transient_local=False, depth=5)
    RELIABLE = QosSpec(reliable=True, transient_local=False, depth=10)


@dataclass(frozen=True, slots=True)
class Published:
    """A topic that carries one kind of event, written as a string by `encode`."""

    topic: str
    qos: Qos
    event: type
    encode: Callable[[Any], str]
    about: str


@dataclass(frozen=True, slots=True)
class Subscribed:
    """A topic whose strings become commands by `decode`, which raises `InvalidValue`."""

    topic: str
    qos: Qos
    decode: Callable[[str], Incoming]
    about: str


def _text(event: Transcribed | Responded | TokenGenerated | SentenceReady) -> str:
    return event.text


def _json(data: Mapping[str, Any]) -> str:
    return json.dumps(data, ensure_ascii=False, allow_nan=False, default=str)


def _state(event: StateChanged) -> str:
    return str(event.state)


def _metrics(event: TurnMeasured) -> str:
    seconds = asdict(event)
    del seconds["turn"]
    return _json({name: round(value, 4) for name, value in seconds.items()})


def _agent_event(event: AgentEvent) -> str:
    return _json({"kind": str(event.kind), **event.data})


def _robot_state(event: RobotState) -> str:
    return _json(event.data)


COMMANDS: Mapping[str, Incoming] = {"reset": Reset()}
"""What the `command` topic understands."""


def _command(text: str) -> Incoming:
    try:
        return COMMANDS[text.strip()]
    except KeyError:
        raise InvalidValue("command", text, "one of " + ", ".join(COMMANDS)) from None


PUBLISHED: tuple[Published, ...] = (
    Published("transcription", Qos.RELIABLE, Transcribed, _text, "the user's words as text"),
    Published("response", Qos.RELIABLE, Responded, _text, "the bot's full answer"),
    Published("state", Qos.STATE, StateChanged, _state, "what the conversation is doing"),
    Published("metrics", Qos.RELIABLE, TurnMeasured, _metrics, "seconds of each stage, as JSON"),
    Published("robot_state", Qos.STATE, RobotState, _robot_state, "the body's state, as JSON"),
    Published("agent_event", Qos.RELIABLE, AgentEvent, _agent_event, "a deed, as JSON"),
    Published("bot_token", Qos.SENSOR, TokenGenerated, _text, "one token as it is generated"),
    Published("bot_sentence", Qos.RELIABLE, SentenceReady, _text, "one sentence as it is spoken"),
)

SUBSCRIBED: tuple[Subscribed, ...] = (
    Subscribed("text_input", Qos.RELIABLE, TextInput, "text for the agent, as if typed"),
    Subscribed("interrupt", Qos.RELIABLE, lambda _: Interrupt(), "any message stops everything"),
    Subscribed("command", Qos.RELIABLE, _command, "one of " + ", ".join(COMMANDS)),
)
