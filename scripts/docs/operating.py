"""The tables of docs/deployment.md and docs/monitoring.md, for those who operate a robot."""

import re
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from pydantic import BaseModel, ConfigDict, TypeAdapter

from docs.components import COMPONENTS
from docs.markdown import code, table
from edgevox.apps.container import ENVIRONMENT
from edgevox.apps.container.environment import Variable
from edgevox.apps.doctor.checks import CHECKS
from edgevox.core.settings import Settings
from edgevox.ops.metric_table import METRICS


def components() -> str:
    """What each component says of itself on /diagnostics."""
    rows = ((f"`{one.name}`", one.about, one.warns, one.errs, one.remedy) for one in COMPONENTS)
    return table(("component", "what", "WARN", "ERROR", "what to do"), rows)


def checks() -> str:
    """What the doctor looks at."""
    return f"{code(one.name for one in CHECKS)}.\n"


def environment() -> str:
    """The variables of the container."""
    rows = ENVIRONMENT.values()
    cells = ((f"`{row.variable}`", _default(row), row.sentence, row.values) for row in rows)
    return table(("variable", "default", "what", "values"), cells)


def _default(row: Variable) -> str:
    """A variable's default; empty without one."""
    if row.shown:
        return row.shown
    if row.default or not row.setting:
        return f"`{row.default}`" if row.default else ""
    value = Settings.model_fields[row.setting].default
    return "" if value in (None, "") else f"`{str(value).lower()}`"


def metrics() -> str:
    """All metrics; those of a process, and of servers that hear and speak, by their names."""
    usual = [name for name in METRICS if name.startswith("process_")]
    alike = [name for name in METRICS if re.sub("_(stt|tts)_", "_llm_", name, count=1) != name]
    rows = (
        (f"`{one.name}`", one.kind, _labels(one.labels), one.help, one.of)
        for one in METRICS.values()
        if one.name not in usual and one.name not in alike
    )
    return f"""{table(("metric", "kind", "labels", "what", "available for"), rows)}
The same of hearing and speech on a server: {code(alike)}.
On Linux, every agent also has the usual metrics of a process: {code(usual)}.
"""


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
    """The events that want somebody's attention, then the names of the others."""
    told = {kind: [name for name in log_events() if _kind(name) == kind] for kind in _KINDS}
    rows = (
        (f"`{name}`", one.level.replace("exception", "error"), one.when, code(one.fields))
        for name, one in log_events().items()
        if name in told["fault"]
    )
    events = table(("event", "level", "when", "fields"), rows)
    return f"""{events}
**An exception was caught** (level error; the traceback is in `exception`), and the rest goes on.
Report it, unless it comes from your own code: {code(told["exception"])}.

**Levels info and debug** tell what goes on: {code(told["news"])}.
"""


_KINDS = ("fault", "exception", "news")


def _kind(name: str) -> str:
    levels = set(log_events()[name].level.split(", "))
    if levels == {"exception"}:
        return "exception"
    return "news" if levels <= {"info", "debug"} else "fault"
