"""The recorded topics, with their types and qualities of service."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from rclpy.qos import QoSProfile

from edgevox.core.errors import InvalidValue
from edgevox.ros2.contract import PUBLISHED, SUBSCRIBED
from edgevox.ros2.contract_rows import QosSpec, lossy
from edgevox.ros2.messages import profile
from edgevox.ros2.standard_topics import AUDIO, INTEROP

DEPTH = 50
"""Messages of a topic that may wait for the recorder's executor."""

_ANY = lossy(10)
"""Hears every publisher."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """A topic by its full name; `qos` is that of the contract. Each is itself only."""

    name: str
    type: str
    qos: QosSpec

    @property
    def listening(self) -> QoSProfile:
        """The same quality of service, with room for more messages."""
        return profile(self.qos, at_least=DEPTH)


def choose_topics(namespace: str, names: Sequence[str] = ()) -> tuple[Recorded, ...]:
    """The topics of these names; without any, those of the contract but sound.

    A name is the contract's, or ``/other/topic:package/msg/Type``. Raises `InvalidValue`.
    """
    known = {**_contract(), **_sound()}
    if not names:
        return tuple(_at(namespace, one) for one in _contract().values())
    return tuple(_at(namespace, _chosen(name, known)) for name in dict.fromkeys(names))


def message_class(kind: str) -> Any:
    """The class of a message type. Raises `InvalidValue` where it is not installed."""
    package, _, name = kind.partition("/msg/")
    try:
        return getattr(import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError, ValueError):
        raise InvalidValue(
            "topics", kind, "a message type that is installed, such as std_msgs/msg/String"
        ) from None


def _contract() -> dict[str, Recorded]:
    own = [Recorded(row.topic, row.type, row.qos.value) for row in PUBLISHED]
    own += [Recorded(row.topic, row.type, row.qos.value) for row in SUBSCRIBED]
    standard = [Recorded(row.topic, row.type, row.qos) for row in INTEROP]
    return _by_name([*own, *standard])


def _sound() -> dict[str, Recorded]:
    return _by_name(Recorded(row.topic, row.type, row.qos) for row in AUDIO)


def _by_name(topics: Iterable[Recorded]) -> dict[str, Recorded]:
    return {one.name: one for one in topics}


def _chosen(name: str, known: Mapping[str, Recorded]) -> Recorded:
    topic, _, kind = name.partition(":")
    if kind:
        message_class(kind)
        return Recorded(topic, kind, _ANY)
    if topic not in known:
        raise InvalidValue("topics", name, "NAME:TYPE, or of " + ", ".join(known))
    return known[topic]


def _at(namespace: str, topic: Recorded) -> Recorded:
    if topic.name.startswith("/"):
        return topic
    return Recorded(f"{namespace.rstrip('/')}/{topic.name}", topic.type, topic.qos)
