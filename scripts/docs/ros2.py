"""The tables of docs/ros2.md, from `edgevox.ros2.contract`."""

from collections.abc import Iterable
from dataclasses import fields
from typing import get_args

from docs.markdown import code, first_line, table
from edgevox.core.agent_events import AgentEvent, keys
from edgevox.ros2 import contract, standard_topics
from edgevox.ros2.contract_rows import Published, Qos, QosSpec, Shared, Subscribed


def qos() -> str:
    """What the names of the qualities of service stand for."""
    rows = (
        (
            f"`{one.name.lower()}`",
            "reliable" if one.value.reliable else "best effort",
            "transient local" if one.value.transient_local else "volatile",
            one.value.depth,
        )
        for one in Qos
    )
    return table(("QoS", "reliability", "durability", "depth"), rows)


def published() -> str:
    """What the node says."""
    return _topics(contract.PUBLISHED)


def agent_events() -> str:
    """What `agent_event` tells, by the classes that are published."""
    rows = (
        (
            f"`{one.kind}`",
            first_line(one.__doc__),
            ", ".join(f"`{key}`" for each in fields(one) for key in keys(each)),
        )
        for one in get_args(AgentEvent)
    )
    return table(("kind", "what happened", "more keys"), rows)


def subscribed() -> str:
    """What the node listens to."""
    return _topics(contract.SUBSCRIBED)


def parameters() -> str:
    """What can be set."""
    rows = (
        (
            f"`{one.name}`",
            type(one.default).__name__.replace("str", "string"),
            f"`{str(one.default).lower()}`" if one.default != "" else "empty",
            one.about,
            one.constraints,
        )
        for one in contract.PARAMETERS
    )
    return table(("parameter", "type", "default", "what", "constraints"), rows)


def queries() -> str:
    """What can be asked."""
    return "; ".join(f"`{name}`: {code(keys)}" for name, keys in contract.QUERIES.items()) + ".\n"


def _quality(qos: QosSpec) -> str:
    """A quality of service in a few words."""
    durable = ", transient local" if qos.transient_local else ""
    return f"{'reliable' if qos.reliable else 'best effort'}{durable}, {qos.depth}"


def interop() -> str:
    """The standard topics of a body."""
    rows = (
        (
            f"`{one.topic}`",
            one.direction,
            f"`{one.type}`",
            _quality(one.qos),
            f"{one.rate_hz:g} Hz" if one.rate_hz else "",
            one.about,
            one.needs,
        )
        for one in standard_topics.INTEROP
    )
    heads = ("topic", "direction", "type", "QoS, depth", "rate", "what", "for a body with")
    return table(heads, rows)


def external() -> str:
    """The topics of a robot that is driven from outside."""
    rows = (
        (
            f"`{one.topic}`",
            one.direction,
            " or ".join(f"`{type_}`" for type_ in one.types),
            _quality(one.qos),
            one.about,
            one.needs,
        )
        for one in standard_topics.EXTERNAL
    )
    return table(("topic", "direction", "type", "QoS, depth", "what", "when"), rows)


def more() -> str:
    """Sound, the state of the components, and what agents and robots say to each other."""
    rows = [
        (f"`{one.topic}`", one.direction, f"`{one.type}`", _quality(one.qos), "", _needed(one))
        for one in standard_topics.AUDIO
    ]
    for other in (contract.DIAGNOSTICS, *contract.SHARED, contract.HEARERS):
        direction = other.direction if isinstance(other, Shared) else "out"
        rate = f"{other.rate_hz:g} Hz" if other.rate_hz else ""
        named = (f"`{other.topic}`", direction, f"`{other.type}`", _quality(other.qos.value))
        rows.append((*named, rate, other.about))
    return table(("topic", "direction", "type", "QoS, depth", "rate", "what"), rows)


def _needed(one: standard_topics.StandardTopic) -> str:
    return f"{one.about}; with `{one.needs}`"


def _topics(rows: Iterable[Published | Subscribed]) -> str:
    cells = (
        (f"`{row.topic}`", f"`{row.type}`", f"`{row.qos.name.lower()}`", row.about) for row in rows
    )
    return table(("topic", "type", "QoS", "what"), cells)
