"""The row types of the contract, which `contract` fills."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from types import UnionType
from typing import Any

from edgevox.core.commands import (
    CancelProgram,
    Interrupt,
    Query,
    Reset,
    RunSkill,
    SetLanguage,
    SetMuted,
    SetVoice,
    Speak,
    TextInput,
)

Incoming = (
    TextInput
    | Speak
    | Interrupt
    | Reset
    | RunSkill
    | CancelProgram
    | SetLanguage
    | SetVoice
    | SetMuted
    | Query
)
"""The commands that come in over ROS 2."""

STRING = "std_msgs/msg/String"


@dataclass(frozen=True, slots=True)
class QosSpec:
    """A quality of service, in ROS 2's own words."""

    reliable: bool
    transient_local: bool
    depth: int


def reliable(depth: int) -> QosSpec:
    """Never lost; suits best-effort subscribers, too."""
    return QosSpec(reliable=True, transient_local=False, depth=depth)


def latched(depth: int) -> QosSpec:
    """Never lost, and repeated to late subscribers."""
    return QosSpec(reliable=True, transient_local=True, depth=depth)


def lossy(depth: int) -> QosSpec:
    """An old one is worth nothing; hears every publisher."""
    return QosSpec(reliable=False, transient_local=False, depth=depth)


class Qos(Enum):
    """The three qualities of service that the contract knows."""

    STATE = latched(1)
    SENSOR = lossy(5)
    RELIABLE = reliable(10)


@dataclass(frozen=True, slots=True)
class Published:
    """A topic that carries one kind of event; `encode` gives the message's ``data``.

    `rate_hz` 0 is for what comes whenever there is something to say.
    """

    topic: str
    qos: Qos
    event: type | UnionType
    encode: Callable[[Any], str | float]
    """Returns the message's ``data`` for an event."""
    about: str
    type: str = STRING
    rate_hz: float = 0.0
    """0 for a topic that publishes when there is an event."""


@dataclass(frozen=True, slots=True)
class Subscribed:
    """A topic whose strings become commands."""

    topic: str
    qos: Qos
    decode: Callable[[str], Incoming]
    """Returns the command; raises `InvalidValue`."""
    about: str
    type: str = STRING
    verbs: bool = False
    """True if the strings name actions, which the policy may forbid by name. Other topics'
    content is judged where it is understood."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of the node. `constraints` is what its descriptor says a value must be."""

    name: str
    default: str | bool
    about: str
    constraints: str
    read_only: bool = False


@dataclass(frozen=True, slots=True)
class StandardTopic:
    """A standard topic that a body with a capability has; `rate_hz` 0 is for what comes in."""

    topic: str
    type: str
    direction: str
    qos: QosSpec
    about: str
    needs: str
    rate_hz: float = 0.0
    also: tuple[str, ...] = ()
    """Types that a robot may have there in place of `type`."""

    @property
    def types(self) -> tuple[str, ...]:
        """All types that EdgeVox can use there, the usual one first."""
        return (self.type, *self.also)


@dataclass(frozen=True, slots=True)
class Shared:
    """A topic on which the agents of one namespace talk to each other; `rate_hz` 0: as needed."""

    topic: str
    qos: Qos
    direction: str
    about: str
    rate_hz: float = 0.0
    type: str = STRING


@dataclass(frozen=True, slots=True)
class Periodic:
    """A standard topic of the node itself, published at a rate."""

    topic: str
    type: str
    qos: Qos
    rate_hz: float
    about: str
