"""What the agent does, as typed events: calls of skills, goals, hand-overs, stops by a word.

The class says what kind of event it is; `as_json` is the only place that makes JSON of one, for the
topic `agent_event`, the feedback of the action, scenarios and recordings.
"""

from collections.abc import Mapping
from dataclasses import Field, asdict, dataclass, field, fields
from enum import StrEnum
from typing import Any, ClassVar

from edgevox.core.reason import Reason, in_english


class AgentEventKind(StrEnum):
    """The kinds that `agent_event` reports."""

    TOOL_CALL = "tool_call"
    SKILL_GOAL = "skill_goal"
    SKILL_CANCELLED = "skill_cancelled"
    HANDOFF = "handoff"
    SAFETY_PREEMPT = "safety_preempt"
    CONFIRMATION = "confirmation"
    PROGRAM = "program"
    SOFTWARE_STOP = "software_stop"
    DRAIN = "drain"


class GoalStatus(StrEnum):
    """Where a goal is in its life. A goal that was rejected never began to live."""

    ACCEPTED = "accepted"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"
    REJECTED = "rejected"


GOAL_ENDS = (GoalStatus.SUCCEEDED, GoalStatus.FAILED, GoalStatus.CANCELLED)
"""A goal that was accepted ends as one of these, once."""


@dataclass(frozen=True, slots=True)
class ToolCalled:
    """A skill was called: by a `template`, the `model`, a `command`, an `action` or a `program`."""

    kind: ClassVar = AgentEventKind.TOOL_CALL
    skill: str
    arguments: Mapping[str, Any]
    source: str
    turn: int


@dataclass(frozen=True, slots=True)
class GoalChanged:
    """A goal was accepted, runs, progressed, succeeded or failed. `turn` is 0 without one.

    `feedback` is what the skill reports, `result` what it returned, `reason` why it failed; each is
    there only where it applies. In JSON a reason is an `error`, an English sentence, and where it
    has a code also `code` and `values`.
    """

    kind: ClassVar = AgentEventKind.SKILL_GOAL
    goal_id: str
    skill: str
    arguments: Mapping[str, Any]
    status: GoalStatus
    turn: int
    feedback: Mapping[str, Any] | None = None
    result: Mapping[str, Any] | None = None
    reason: Reason | None = field(default=None, metadata={"keys": ("error", "code", "values")})


@dataclass(frozen=True, slots=True)
class GoalCancelled:
    """A goal ended without having succeeded or failed.

    In JSON its reason is `reason`, an English sentence, and where it has a code also `code` and
    `values`.
    """

    kind: ClassVar = AgentEventKind.SKILL_CANCELLED
    goal_id: str
    skill: str
    arguments: Mapping[str, Any]
    status: GoalStatus = field(init=False, default=GoalStatus.CANCELLED)
    turn: int
    reason: Reason = field(metadata={"keys": ("reason", "code", "values")})


@dataclass(frozen=True, slots=True)
class GoalRejected:
    """A goal was rejected as impossible or forbidden. It has no id and no `tool_call`.

    Its arguments are as they came, and `way` is how.
    """

    kind: ClassVar = AgentEventKind.SKILL_GOAL
    goal_id: None = field(init=False, default=None, metadata={"always": True})
    skill: str
    arguments_json: str
    status: GoalStatus = field(init=False, default=GoalStatus.REJECTED)
    reason: Reason = field(metadata={"keys": ("error", "code", "values")})
    way: str | None = None
    turn: int = 0


@dataclass(frozen=True, slots=True)
class HandedOver:
    """One agent hands the conversation over to another."""

    kind: ClassVar = AgentEventKind.HANDOFF
    giver: str = field(metadata={"keys": ("from",)})
    taker: str = field(metadata={"keys": ("to",)})
    turn: int


class HeardBy(StrEnum):
    """What found a stop word: its words, spoken or typed, or the spotter, by their sound alone."""

    WORDS = "words"
    SPOTTER = "spotter"


@dataclass(frozen=True, slots=True)
class SafetyPreempted:
    """A stop word was heard; `stopped` says whether there was anything to stop.

    `heard_by` is ``words``, or ``spotter`` for one that was known by its sound.
    """

    kind: ClassVar = AgentEventKind.SAFETY_PREEMPT
    word: str
    stopped: bool
    heard_by: HeardBy = HeardBy.WORDS


@dataclass(frozen=True, slots=True)
class SoftwareStopChanged:
    """The software stop was engaged or released; `by` says by whom, for people to read."""

    kind: ClassVar = AgentEventKind.SOFTWARE_STOP
    engaged: bool
    by: str


class DrainStatus(StrEnum):
    """How far a drain is; it has no way back."""

    DRAINING = "draining"
    DRAINED = "drained"
    NOT_STANDING = "not_standing"


@dataclass(frozen=True, slots=True)
class DrainChanged:
    """The agent drains: motion may finish within `within_s` seconds, and nothing new begins.

    At the end the robot stands (`drained`), or was halted and is not seen to stand. `by` says
    who asked, for people.
    """

    kind: ClassVar = AgentEventKind.DRAIN
    status: DrainStatus
    by: str
    within_s: float


class ConfirmationStatus(StrEnum):
    """Where a question is in its life: it is asked once, and ends once, as one of the others."""

    ASKED = "asked"
    CONFIRMED = "confirmed"
    DECLINED = "declined"
    EXPIRED = "expired"
    REPLACED = "replaced"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class AskedCall:
    """A call that is done if the answer is yes."""

    skill: str
    arguments: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Confirmation:
    """A question before calls was asked, answered or withdrawn. `turn` asked it.

    It expires `expires_s` seconds after it was said to its end.
    """

    kind: ClassVar = AgentEventKind.CONFIRMATION
    status: ConfirmationStatus
    question: str
    calls: tuple[AskedCall, ...]
    expires_s: float
    turn: int


class ProgramStatus(StrEnum):
    """Where a program is in its life; the last three end it."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    CANCELLED = "cancelled"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class ProgramChanged:
    """A program waits, runs, began another round, or ended. `text` describes it in words.

    `due_in_s` is how long it still waits for its time, `round` how often it has begun its steps;
    the reason says why it failed or was cancelled. Each is there only where it applies.
    """

    kind: ClassVar = AgentEventKind.PROGRAM
    program_id: str
    text: str
    status: ProgramStatus
    turn: int
    due_in_s: float | None = None
    round: int | None = None
    reason: Reason | None = field(default=None, metadata={"keys": ("error", "code", "values")})


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
)
"""Whoever subscribes to this on the bus hears all of them."""


def as_json(event: AgentEvent) -> dict[str, Any]:
    """The JSON object of an event: its kind, and its fields but those that do not apply."""
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
    """A reason as the keys of a JSON object; `text` is the key of its sentence."""
    found: dict[str, Any] = {text: reason.text}
    if reason.code:
        said = {name: in_english(value) for name, value in reason.values.items()}
        found |= {"code": reason.code, "values": said}
    return found


def keys(one: "Field[Any]") -> tuple[str, ...]:
    """What a field is in JSON: one key, or several."""
    return tuple(one.metadata.get("keys", (one.name,)))


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [asdict(one) for one in value]
    return str(value) if isinstance(value, StrEnum) else value


def _is_always_there(one: "Field[Any]") -> bool:
    return bool(one.metadata.get("always"))
