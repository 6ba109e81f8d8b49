"""The contract as data: all that EdgeVox promises on the wire, once.

Topics are relative to the node's namespace unless they begin with a slash. The bridge serves these
rows, `scripts/reference.py` writes the reference page from them, the conformance test checks them.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from edgevox.core.agent_events import AgentEvent, as_json
from edgevox.core.commands import (
    CancelProgram,
    Interrupt,
    Query,
    Reset,
    SetLanguage,
    SetMuted,
    SetVoice,
    Speak,
    TextInput,
)
from edgevox.core.errors import InvalidValue
from edgevox.core.events import (
    Answered,
    AudioLevel,
    Cause,
    Responded,
    RobotState,
    SentenceReady,
    StateChanged,
    TokenGenerated,
    Transcribed,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.core.settings import CONFIRM, Settings
from edgevox.core.status import ComponentName
from edgevox.core.transforms import ODOM_EXPECTED, PREFIX_EXPECTED
from edgevox.ros2.contract_rows import (
    Incoming,
    Parameter,
    Periodic,
    Published,
    Qos,
    Shared,
    StandardTopic,
    Subscribed,
)
from edgevox.ros2.standard_topics import INTEROP

_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False, default=str)
"""The shared encoder: `json.dumps` makes a new one for each call with options."""


def write(data: Mapping[str, Any]) -> str:
    """Write a JSON object that every parser reads: a number that is not finite becomes null."""
    try:
        text = _ENCODER.encode(data)
        text.encode()
    except ValueError:
        return json.dumps(_finite(data), default=str)
    return text


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return value


Queries = Mapping[str, Callable[[], Mapping[str, Any]]]
"""Functions that answer queries, by name."""

NODE_NAME = "edgevox"
RECORDER_NODE = "edgevox_recorder"
EXTERNAL_NODE = "edgevox_external"
"""Beside a robot that `robot-external` drives, in that robot's namespace."""


def _text(event: Transcribed | TokenGenerated | SentenceReady) -> str:
    return event.text


def _written(event: Responded) -> str:
    return event.written


def _state(event: StateChanged) -> str:
    return str(event.state)


def _level(event: AudioLevel) -> float:
    return event.level


def _metrics(event: TurnMeasured) -> str:
    seconds = asdict(event)
    del seconds["turn"]
    return write({name: round(value, 4) for name, value in seconds.items()})


def _agent_event(event: AgentEvent) -> str:
    return write(as_json(event))


def _robot_state(event: RobotState) -> str:
    return write(event.data)


def _wake_word(event: WakeWordHeard) -> str:
    return event.phrase


def _info(event: Answered) -> str:
    return answer_json(event.query, event.data)


def answer_json(query: str, data: Mapping[str, Any]) -> str:
    """An answer as `info` and the services give it."""
    return write({"query": query, **data})


QUERIES: Mapping[str, tuple[str, ...]] = {
    "list_voices": ("language", "current_voice", "voices"),
    "list_languages": ("current", "languages"),
    "hardware_info": ("cuda", "metal", "gpu_name", "vram_total_gb", "vram_used_mb", "ram_gb"),
    "model_info": ("language", "voice", "stt", "llm", "tts"),
    "list_programs": ("programs",),
}
"""The queries, on `command` or as a Trigger service, and the keys of their answers."""

COMMANDS: Mapping[str, Incoming] = {
    "reset": Reset(),
    "mute": SetMuted(True),
    "unmute": SetMuted(False),
    **{name: Query(name) for name in QUERIES},
    "cancel_programs": CancelProgram(),
}
"""The words that the topic `command` understands."""

CANCEL_PROGRAM = "cancel_program"
"""A command that is followed by the id of a program."""
_COMMANDS = ", ".join((*COMMANDS, f"{CANCEL_PROGRAM} ID"))


def _command(text: str) -> Incoming:
    name, _, program_id = text.strip().partition(" ")
    if name == CANCEL_PROGRAM and program_id.strip():
        return CancelProgram(program_id.strip())
    try:
        return COMMANDS[text.strip()]
    except KeyError:
        raise InvalidValue("command", text, f"one of {_COMMANDS}") from None


PUBLISHED: tuple[Published, ...] = (
    Published("transcription", Qos.RELIABLE, Transcribed, _text, "the user's words as text"),
    Published(
        "response",
        Qos.RELIABLE,
        Responded,
        _written,
        "the full answer, including lists that are too long to speak",
    ),
    Published(
        "state",
        Qos.STATE,
        StateChanged,
        _state,
        "listening (also while it drives), transcribing, thinking, speaking or interrupted",
    ),
    Published(
        "audio_level",
        Qos.SENSOR,
        AudioLevel,
        _level,
        "loudness of the microphone, 0 to 1",
        "std_msgs/msg/Float32",
    ),
    Published("metrics", Qos.RELIABLE, TurnMeasured, _metrics, "seconds of each stage, as JSON"),
    Published(
        "robot_state",
        Qos.STATE,
        RobotState,
        _robot_state,
        "the body's state, as JSON",
        rate_hz=Settings.model_fields["ros2_state_hz"].default,
    ),
    Published(
        "agent_event", Qos.RELIABLE, AgentEvent, _agent_event, "the agent's actions, as JSON"
    ),
    Published("bot_token", Qos.SENSOR, TokenGenerated, _text, "each token as it is generated"),
    Published("bot_sentence", Qos.RELIABLE, SentenceReady, _text, "each sentence as it is spoken"),
    Published("wakeword", Qos.RELIABLE, WakeWordHeard, _wake_word, "the detected wake word"),
    Published("info", Qos.RELIABLE, Answered, _info, "the answer to a query, as JSON"),
)

SUBSCRIBED: tuple[Subscribed, ...] = (
    Subscribed("tts_request", Qos.RELIABLE, Speak, "text to speak unchanged"),
    Subscribed("text_input", Qos.RELIABLE, TextInput, "text for the agent, as if typed"),
    Subscribed(
        "interrupt",
        Qos.RELIABLE,
        lambda _: Interrupt(cause=Cause.TOPIC),
        "any message stops everything",
    ),
    Subscribed("set_language", Qos.RELIABLE, SetLanguage, "ISO 639-1 code of the language"),
    Subscribed("set_voice", Qos.RELIABLE, SetVoice, "name of the text-to-speech voice"),
    Subscribed("command", Qos.RELIABLE, _command, f"one of {_COMMANDS}", verbs=True),
)


def _setting(name: str, expected: str, *, at_start: bool = False) -> Parameter:
    """A setting as a parameter: to be changed at any time, or to be overruled at the start only."""
    field = Settings.model_fields[name]
    constraints = f"{expected}; set at start" if at_start else expected
    return Parameter(name, field.default, field.description or "", constraints, at_start)


PARAMETERS: tuple[Parameter, ...] = (
    _setting("language", "a code of list_languages"),
    _setting("voice", "empty for the language's best, or a name of list_voices"),
    _setting("muted", "true or false"),
    _setting("confirm", "one of " + ", ".join(CONFIRM)),
    _setting("odom_frame", ODOM_EXPECTED, at_start=True),
    _setting("frame_prefix", PREFIX_EXPECTED, at_start=True),
    _setting("publish_clock", "true or false", at_start=True),
)

DIAGNOSTICS = Periodic(
    "/diagnostics",
    "diagnostic_msgs/msg/DiagnosticArray",
    Qos.RELIABLE,
    1.0,
    "status of each component: " + ", ".join(ComponentName),
)
"""Published by every agent, with a robot or without: an addition for monitoring."""

PRESENCE = Shared(
    "presence",
    Qos.STATE,
    "out, in",
    "a running agent, as JSON: id, robot, host, pid, since_ns, term, leaving, in_charge",
    1.0,
)
TAKE_OVER = Shared(
    "take_over",
    Qos.RELIABLE,
    "in",
    "the id of the agent that moves the robot from now on; all others halt",
)
SHARED: tuple[Shared, ...] = (PRESENCE, TAKE_OVER)
"""Topics that settle which of several agents on one namespace moves the robot: pure additions."""
HEARERS = Shared(
    "/hearers",
    Qos.SENSOR,
    "out, in",
    "with `answer_group`: a robot of the group, and how well it hears an utterance, as JSON: id,"
    " name, group, beat, utterance, ago_ms, lasted_ms, woken_ms, level_db, asked, words, waited,"
    " named, answers, says, leaving",
)
"""Settles which of several robots answers an utterance. Common to all robots of a domain."""

Rated = Published | StandardTopic | Shared | Periodic
_OURS: tuple[Rated, ...] = (*PUBLISHED, *INTEROP, *SHARED, DIAGNOSTICS)
RATED: tuple[Rated, ...] = tuple(row for row in _OURS if row.rate_hz)
"""The rows that are published at a rate."""

ACTION = ("execute_skill", "edgevox_msgs/action/ExecuteSkill")
"""The action's name and type."""
