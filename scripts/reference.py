"""What is generated in docs: `write` renews it, `check` only looks.

The tables of ros2.md come from `edgevox.ros2.contract` and the launch files, those of deployment.md
from `edgevox.apps.container`, those of diagnostics.md from `edgevox.ops.diagnostics` and
`edgevox.apps.doctor`, that of metrics.md from `edgevox.ops.metrics`. They stand between
``<!-- generated: NAME -->`` and ``<!-- end -->``; all else on a page is written by hand.
scenario.schema.json, policy.schema.json and robot.schema.json are the formats of such files as
JSON Schemas.
"""

import ast
import json
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import get_args

from edgevox.agent.policy.format import PolicyFile
from edgevox.apps.container import ENVIRONMENT, Variable
from edgevox.apps.doctor.checks import CHECKS
from edgevox.core.agent_events import AgentEvent, keys
from edgevox.ops.diagnostics.component_table import COMPONENTS
from edgevox.ops.logs.event_table import log_events
from edgevox.ops.metrics.metric_table import METRICS
from edgevox.ros2 import contract, standard_topics
from edgevox.ros2.contract_rows import Published, Qos, QosSpec, Subscribed
from edgevox.ros2.robot_file.robot_file_format import RobotFile
from edgevox.scenario import Scenario

ROOT = Path(__file__).resolve().parent.parent
NAMES = ("ros2", "deployment", "logs", "diagnostics", "metrics")
PAGES = tuple(ROOT / "docs" / f"{name}.md" for name in NAMES)
SCHEMAS = {
    ROOT / "docs" / "scenario.schema.json": Scenario,
    ROOT / "docs" / "policy.schema.json": PolicyFile,
    ROOT / "docs" / "robot.schema.json": RobotFile,
}
LAUNCH = ROOT / "launch"
BLOCK = re.compile(r"(<!-- generated: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


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


PARTS = {
    part.__name__: part
    for part in (
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


def renewed(page: str) -> str:
    """The page with each generated part as it should be."""
    return BLOCK.sub(lambda found: found[1] + PARTS[found[2]]() + found[3], page)


def schemas() -> dict[Path, str]:
    """What editors and other programs need to know of the files that people write."""
    return {
        file: json.dumps(kind.model_json_schema(), indent=2, allow_nan=False) + "\n"
        for file, kind in SCHEMAS.items()
    }


def main(arguments: list[str]) -> int:
    """Run `write` or `check`; 2 for anything else."""
    pages = {page: page.read_text(encoding="utf-8") for page in PAGES}
    there = {name for text in pages.values() for _, name, _ in BLOCK.findall(text)}
    if missing := PARTS.keys() - there:
        sys.stderr.write(f"docs: no part generated: {', '.join(sorted(missing))}\n")
        return 1
    wanted = {page: renewed(text) for page, text in pages.items()} | schemas()
    match arguments:
        case ["write"]:
            for file, text in wanted.items():
                file.write_text(text, encoding="utf-8")
            return 0
        case ["check"]:
            old = [
                file.name
                for file, text in wanted.items()
                if file.read_text(encoding="utf-8") != text
            ]
            for name in old:
                sys.stderr.write(f"{name}: not current; run scripts/reference.py write\n")
            return 1 if old else 0
    sys.stderr.write("usage: reference.py write|check\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
