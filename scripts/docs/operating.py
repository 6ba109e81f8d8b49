"""The tables of docs/deployment.md and docs/monitoring.md, for those who operate a robot."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path

import yaml
from pydantic import BaseModel, ConfigDict, TypeAdapter

from docs.components import COMPONENTS
from docs.markdown import table
from docs.told import told
from edgevox.apps.container import ENVIRONMENT
from edgevox.apps.doctor.checks import CHECKS
from edgevox.ops.metric_table import METRICS

ALERTS = Path(__file__).resolve().parents[2] / "compose" / "observability" / "alerts.yml"


def components() -> str:
    """What each component says of itself on /diagnostics."""
    rows = ((f"`{one.name}`", one.about, one.warns, one.errs, one.remedy) for one in COMPONENTS)
    return table(("component", "what", "WARN", "ERROR", "what to do"), rows)


def checks() -> str:
    """What the doctor looks at."""
    return table(("check", "what should be"), ((f"`{one.name}`", one.about) for one in CHECKS))


def environment() -> str:
    """The variables of the container."""
    rows = ENVIRONMENT.values()
    cells = ((f"`{row.variable}`", row.default_text, row.sentence, row.values) for row in rows)
    return table(("variable", "default", "what", "values"), cells)


def metrics() -> str:
    """All metrics."""
    rows = (
        (f"`{one.name}`", one.kind, _labels(one.labels), one.help, one.of)
        for one in METRICS.values()
    )
    return table(("metric", "kind", "labels", "what", "available for"), rows)


def alerts() -> str:
    """What to do about each alert, in the order of its file."""
    groups = yaml.safe_load(ALERTS.read_text(encoding="utf-8"))["groups"]
    names = [rule["alert"] for group in groups for rule in group["rules"]]
    entries = told(names, "alerts")
    rows = ((name, entries[name]["means"], entries[name]["do"]) for name in names)
    return table(("alert", "what happened", "what to do"), rows)


def _labels(labels: Mapping[str, tuple[str, ...] | str]) -> str:
    """What a metric is told apart by."""
    return "; ".join(
        f"`{name}`: {known if isinstance(known, str) else ', '.join(known)}"
        for name, known in labels.items()
    )


class LogEvent(BaseModel):
    """An event: how severe it is, which fields its line has, when it happens."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    level: str
    fields: tuple[str, ...]
    when: str


@cache
def log_events() -> Mapping[str, LogEvent]:
    """All events by name, read from `events.toml`."""
    text = files("edgevox.ops.logs").joinpath("events.toml").read_text(encoding="utf-8")
    return TypeAdapter(dict[str, LogEvent]).validate_python(tomllib.loads(text))


def logs() -> str:
    """Every event that is logged."""
    rows = (
        (f"`{name}`", one.level, one.when, ", ".join(f"`{field}`" for field in one.fields))
        for name, one in log_events().items()
    )
    return table(("event", "level", "when", "fields"), rows)
