"""The tables of the reference pages, in Markdown, each from where its facts are declared.

Those of ros2.md come from `edgevox.ros2.contract` and the launch files, those of deployment.md from
`edgevox.apps.container`, those of diagnostics.md from `edgevox.ops.diagnostics` and
`edgevox.apps.doctor`, that of metrics.md from `edgevox.ops.metrics`, that of logs.md from
`edgevox.ops.logs`.
"""

import ast
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import get_args

from edgevox.apps.container import ENVIRONMENT, Variable
from edgevox.apps.doctor.checks import CHECKS
from edgevox.core.agent_events import AgentEvent, keys
from edgevox.ops.diagnostics.component_table import COMPONENTS
from edgevox.ops.logs.event_table import log_events
from edgevox.ops.metrics.metric_table import METRICS
from edgevox.ros2 import contract, standard_topics
from edgevox.ros2.contract_rows import Published, Qos, QosSpec, Subscribed

LAUNCH = Path(__file__).resolve().parent.parent / "launch"


def table(heads: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A Markdown table."""
    heads = tuple(heads)
    lines = [heads, ("---",) * len(heads), *rows]
    cells = ((str(cell).replace("|", "\\|") for cell in line) for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


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
            _first_line(one.__doc__),
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
        (f"`{one.topic}`", one.direction, f"`{one.type}`", _quality(one.qos), one.about, one.needs)
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
    rows = (
        (
            f"`{one.topic}`",
            one.direction,
            f"`{one.type}`",
            f"`{one.qos.name.lower()}`",
            f"{one.rate_hz:g} Hz" if one.rate_hz else "",
            one.about,
        )
        for one in contract.SHARED
    )
    return table(("topic", "direction", "type", "QoS", "rate", "what"), rows)


def components() -> str:
    """What each component says of itself on /diagnostics."""
    rows = ((f"`{one.name}`", one.about, one.warns, one.errs, one.remedy) for one in COMPONENTS)
    return table(("component", "what", "WARN", "ERROR", "what to do"), rows)


def checks() -> str:
    """What the doctor looks at."""
    return table(("check", "what should be"), ((f"`{one.name}`", one.about) for one in CHECKS))


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
    return table(("launch file", "what"), ((name, _first_line(about)) for name, about in rows))


def launch_arguments() -> str:
    """What all launch files take."""
    for node in ast.parse((LAUNCH / "edgevox.launch.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "ARGUMENTS":
            arguments = ast.literal_eval(node.value)
    rows = ((f"`{name}`", about) for name, about in arguments.items())
    return table(("argument", "what"), rows)


def environment() -> str:
    """The variables of the container."""
    return _variables(row for row in ENVIRONMENT.values() if row.listed)


def more_environment() -> str:
    """The variables of all other settings."""
    return _variables(row for row in ENVIRONMENT.values() if not row.listed)


def metrics() -> str:
    """All metrics."""
    rows = (
        (f"`{one.name}`", one.kind, _labels(one.labels), one.help, one.of)
        for one in METRICS.values()
    )
    return table(("metric", "kind", "labels", "what", "who has it"), rows)


def _labels(labels: Mapping[str, tuple[str, ...] | str]) -> str:
    """What a metric is told apart by."""
    return "; ".join(
        f"`{name}`: {known if isinstance(known, str) else ', '.join(known)}"
        for name, known in labels.items()
    )


def logs() -> str:
    """Every event that is logged."""
    rows = (
        (f"`{name}`", one.level, one.when, ", ".join(f"`{field}`" for field in one.fields))
        for name, one in log_events().items()
    )
    return table(("event", "level", "when", "fields"), rows)


def _variables(rows: Iterable[Variable]) -> str:
    cells = ((f"`{row.variable}`", row.default_text, row.sentence, row.values) for row in rows)
    return table(("variable", "default", "what", "values"), cells)


def _topics(rows: Iterable[Published | Subscribed]) -> str:
    cells = (
        (f"`{row.topic}`", f"`{row.type}`", f"`{row.qos.name.lower()}`", row.about) for row in rows
    )
    return table(("topic", "type", "QoS", "what"), cells)


def _first_line(docstring: str | None) -> str:
    return (docstring or "").partition("\n")[0]


TABLES = {
    one.__name__: one
    for one in (
        qos,
        published,
        agent_events,
        subscribed,
        parameters,
        queries,
        interop,
        external,
        audio,
        diagnostics,
        shared,
        components,
        checks,
        action,
        launch,
        launch_arguments,
        environment,
        more_environment,
        logs,
        metrics,
    )
}
"""By the name that stands where each belongs."""
