"""Agent events: calls of skills, goals, hand-overs, stops by a word.

Each kind of event is a class. Only `as_json` turns an event into JSON, for the topic `agent_event`,
the feedback of the action, scenarios and recordings.
"""

from collections.abc import Mapping
from dataclasses import Field, asdict, dataclass, field, fields
from enum import StrEnum
from typing import Any, ClassVar

from edgevox.core.reason import Reason, in_english


class AgentEventKind(StrEnum):
    """Kinds of events that the topic `agent_event` reports."""

    TOOL_CALL = "tool_call"
    SKILL_GOAL = "skill_goal"
    SKILL_CANCELLED = "skill_cancelled"
    HANDOFF = "handoff"
    SAFETY_PREEMPT = "safety_preempt"
    CONFIRMATION = "confirmation"
    PROGRAM = "program"
    SOFTWARE_STOP = "software_stop"
    DRAIN = "drain"
    UTTERANCE_LEFT = "utterance_left"


class GoalStatus(StrEnum):
    """Stages in the life of a goal. A rejected goal never began its life."""

    ACCEPTED = "accepted"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"
    REJECTED = "rejected"


GOAL_ENDS = (GoalStatus.SUCCEEDED, GoalStatus.FAILED, GoalStatus.CANCELLED)
"""The ends of a goal: an accepted goal reaches exactly one of these, once."""


@dataclass(frozen=True, slots=True)
class ToolCalled:
    """A skill was called, by `template`, `reading`, `command`, `action` or `program`."""

    kind: ClassVar = AgentEventKind.TOOL_CALL
    skill: str
    """The skill's name."""
    arguments: Mapping[str, Any]
    """Its checked arguments."""
    source: str
    """The caller: a stage of understanding (``template``, ``reading``), or ``command``,
    ``action`` or ``program``."""
    turn: int
    """Number of the turn that called; 0 for none."""


@dataclass(frozen=True, slots=True)
class GoalChanged:
    """A goal was accepted, runs, progressed, succeeded or failed; `turn` is 0 without a turn."""

    kind: ClassVar = AgentEventKind.SKILL_GOAL
    goal_id: str
    """The goal's id."""
    skill: str
    """The name of the skill that it runs."""
    arguments: Mapping[str, Any]
    """The skill's checked arguments."""
    status: GoalStatus
    """The goal's status from now on."""
    turn: int
    """Number of the turn that asked for the goal; 0 for none."""
    feedback: Mapping[str, Any] | None = None
    """Progress that the skill reports; None in an event that reports none."""
    result: Mapping[str, Any] | None = None
    """The skill's result; None unless the goal succeeded."""
    reason: Reason | None = field(default=None, metadata={"keys": ("error", "code", "values")})
    """The reason of a failure. In JSON: `error`, an English sentence, and for a reason with a code
    also `code` and `values`."""


@dataclass(frozen=True, slots=True)
class GoalCancelled:
    """A goal was cancelled: it ended without having succeeded or failed."""

    kind: ClassVar = AgentEventKind.SKILL_CANCELLED
    goal_id: str
    skill: str
    arguments: Mapping[str, Any]
    status: GoalStatus = field(init=False, default=GoalStatus.CANCELLED)
    turn: int
    reason: Reason = field(metadata={"keys": ("reason", "code", "values")})
    """The reason. In JSON: `reason`, an English sentence, and for a reason with a code also `code`
    and `values`."""


@dataclass(frozen=True, slots=True)
class GoalRejected:
    """A goal was rejected as impossible or forbidden. It has no id and no `tool_call`."""

    kind: ClassVar = AgentEventKind.SKILL_GOAL
    goal_id: None = field(init=False, default=None, metadata={"always": True})
    skill: str
    arguments_json: str
    """The arguments as they came, unchecked, in JSON."""
    status: GoalStatus = field(init=False, default=GoalStatus.REJECTED)
    reason: Reason = field(metadata={"keys": ("error", "code", "values")})
    """The reason, in JSON as that of `GoalChanged`."""
    way: str | None = None
    """The way in which the goal was asked for."""
    turn: int = 0
    """Number of the turn that asked for the goal; 0 for none."""


@dataclass(frozen=True, slots=True)
class HandedOver:
    """An agent, the giver, hands the conversation over to another, the taker."""

    kind: ClassVar = AgentEventKind.HANDOFF
    giver: str = field(metadata={"keys": ("from",)})
    taker: str = field(metadata={"keys": ("to",)})
    turn: int


class HeardBy(StrEnum):
    """Ways to find a stop word: in spoken or typed words, or by the spotter, in sound alone."""

    WORDS = "words"
    SPOTTER = "spotter"


@dataclass(frozen=True, slots=True)
class SafetyPreempted:
    """A stop word was heard; `stopped` tells whether there was anything to stop."""

    kind: ClassVar = AgentEventKind.SAFETY_PREEMPT
    word: str
    """The stop word, as the table of stop words spells it."""
    stopped: bool
    """True if there was anything to stop."""
    heard_by: HeardBy = HeardBy.WORDS
    """``words``, or ``spotter`` if only its sound was heard."""


@dataclass(frozen=True, slots=True)
class SoftwareStopChanged:
    """The software stop was engaged or released; `by` tells by whom, for people to read."""

    kind: ClassVar = AgentEventKind.SOFTWARE_STOP
    engaged: bool
    """True for engaged, False for released."""
    by: str
    """The person or program that did it, for people to read."""


class DrainStatus(StrEnum):
    """Stages of a drain, which cannot be undone."""

    DRAINING = "draining"
    DRAINED = "drained"
    NOT_STANDING = "not_standing"


@dataclass(frozen=True, slots=True)
class DrainChanged:
    """The agent drains: motion may finish within `within_s` seconds, and nothing new begins."""

    kind: ClassVar = AgentEventKind.DRAIN
    status: DrainStatus
    """``draining``; at the end ``drained`` if the robot stands, or ``not_standing`` if it was
    halted and is not seen to stand."""
    by: str
    """The person or program that asked, for people to read."""
    within_s: float
    """Seconds that running motion may still take; 0 at the end."""


@dataclass(frozen=True, slots=True)
class UtteranceLeft:
    """The robot heard an utterance and leaves it to another robot of its group."""

    kind: ClassVar = AgentEventKind.UTTERANCE_LEFT
    robot: str
    """The name of the robot that answers, as that robot says it."""


class ConfirmationStatus(StrEnum):
    """Stages in the life of a question: `asked`, then one of the others, which ends it."""

    ASKED = "asked"
    CONFIRMED = "confirmed"
    COUNTED_DOWN = "counted_down"
    DECLINED = "declined"
    EXPIRED = "expired"
    REPLACED = "replaced"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class AskedCall:
    """A call that a yes carries out."""

    skill: str
    arguments: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Confirmation:
    """A question or a countdown before calls began or ended; `turn` is the turn that asked."""

    kind: ClassVar = AgentEventKind.CONFIRMATION
    status: ConfirmationStatus
    """The question's stage from now on."""
    question: str
    """The question as it is said; for a countdown what the robot says that it will do."""
    calls: tuple[AskedCall, ...]
    """The calls that a yes carries out."""
    expires_s: float
    """Seconds from the end of the spoken question until it expires, or until a countdown ends."""
    turn: int
    """Number of the turn that asked."""
    goes: bool = False
    """True for a countdown: the calls are done when its time is over, unless a person says no."""


class ProgramStatus(StrEnum):
    """Stages in the life of a program; the last three end it."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    CANCELLED = "cancelled"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class ProgramChanged:
    """A program waits, runs, began another round, or ended; `text` describes it in words."""

    kind: ClassVar = AgentEventKind.PROGRAM
    program_id: str
    """The program's id."""
    text: str
    """The program described in words."""
    status: ProgramStatus
    """The program's stage from now on."""
    turn: int
    """Number of the turn that asked for the program."""
    due_in_s: float | None = None
    """Seconds until the program's time; None if it waits for no time."""
    round: int | None = None
    """Number of times that the program has begun its steps; None if it does not repeat them."""
    reason: Reason | None = field(default=None, metadata={"keys": ("error", "code", "values")})
    """The reason of a failure or cancellation, in JSON as that of `GoalChanged`."""


AgentEvent = (
    ToolCalled
    | GoalChanged
    | GoalCancelled
    | GoalRejected
    | HandedOver
    | SafetyPreempted
    | Confirmation
    | ProgramChanged
    | SoftwareStopChanged
    | DrainChanged
    | UtteranceLeft
)
"""All agent events: a subscription to this type on the bus gets each of them."""


def as_json(event: AgentEvent) -> dict[str, Any]:
    """The JSON object of an event: its kind, and those of its fields that apply."""
    found: dict[str, Any] = {"kind": str(event.kind)}
    for one in fields(event):
        value = getattr(event, one.name)
        if isinstance(value, Reason):
            found |= reason_json(value, keys(one)[0])
        elif value is not None or _is_always_there(one):
            (name,) = keys(one)
            found[name] = _plain(value)
    return found


def reason_json(reason: Reason, text: str = "error") -> dict[str, Any]:
    """The JSON object of a reason; `text` is the key of its sentence."""
    found: dict[str, Any] = {text: reason.text}
    if reason.code:
        said = {name: in_english(value) for name, value in reason.values.items()}
        found |= {"code": reason.code, "values": said}
    return found


def keys(one: "Field[Any]") -> tuple[str, ...]:
    """The keys of a field in JSON."""
    return tuple(one.metadata.get("keys", (one.name,)))


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [asdict(one) for one in value]
    return str(value) if isinstance(value, StrEnum) else value


def _is_always_there(one: "Field[Any]") -> bool:
    return bool(one.metadata.get("always"))
