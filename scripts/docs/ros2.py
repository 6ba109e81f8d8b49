"""The tables of docs/ros2.md: from `edgevox.ros2.contract`, and from the launch files."""

import ast
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import get_args

from docs.markdown import first_line, table
from edgevox.core.agent_events import AgentEvent, keys
from edgevox.ros2 import contract, standard_topics
from edgevox.ros2.contract_rows import Published, Qos, QosSpec, Shared, Subscribed

LAUNCH = Path(__file__).resolve().parents[2] / "launch"


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
    rows = (
        (f"`{name}`", ", ".join(f"`{key}`" for key in keys))
        for name, keys in contract.QUERIES.items()
    )
    return table(("query", "keys of the answer"), rows)


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


def audio() -> str:
    """Sound on the wire."""
    rows = (
        (f"`{one.topic}`", one.direction, f"`{one.type}`", one.about, f"`{one.needs}`")
        for one in standard_topics.AUDIO
    )
    return table(("topic", "direction", "type", "what", "when"), rows)


def diagnostics() -> str:
    """How the components are, on the wire."""
    one = contract.DIAGNOSTICS
    row = (f"`{one.topic}`", f"`{one.type}`", f"`{one.qos.name.lower()}`", f"{one.rate_hz:g} Hz")
    return table(("topic", "type", "QoS", "rate", "what"), [(*row, one.about)])


def shared() -> str:
    """What the agents of one namespace say to each other."""
    return _between(*contract.SHARED)


def group() -> str:
    """What the robots of a group say to each other."""
    return _between(contract.HEARERS)


def _between(*these: Shared) -> str:
    rows = (
        (
            f"`{one.topic}`",
            one.direction,
            f"`{one.type}`",
            f"`{one.qos.name.lower()}`",
            f"{one.rate_hz:g} Hz" if one.rate_hz else "",
            one.about,
        )
        for one in these
    )
    return table(("topic", "direction", "type", "QoS", "rate", "what"), rows)


def action() -> str:
    """The one action."""
    name, kind = contract.ACTION
    return table(("action", "type"), [(f"`{name}`", f"`{kind}`")])


def launch() -> str:
    """The launch files."""
    files = sorted(LAUNCH.glob("*.launch.py"))
    rows = (
        (f"`{file.name}`", ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))))
        for file in files
    )
    return table(("launch file", "what"), ((name, first_line(about)) for name, about in rows))


def launch_arguments() -> str:
    """What all launch files take."""
    for node in ast.parse((LAUNCH / "edgevox.launch.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "ARGUMENTS":
            arguments = ast.literal_eval(node.value)
    rows = ((f"`{name}`", about) for name, about in arguments.items())
    return table(("argument", "what"), rows)


def _topics(rows: Iterable[Published | Subscribed]) -> str:
    cells = (
        (f"`{row.topic}`", f"`{row.type}`", f"`{row.qos.name.lower()}`", row.about) for row in rows
    )
    return table(("topic", "type", "QoS", "what"), cells)
