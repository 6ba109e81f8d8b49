"""The table of events, read from `events.toml`."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from pydantic import BaseModel, ConfigDict, TypeAdapter


class LogEvent(BaseModel):
    """One event: how severe it is, which fields its line has, when it happens."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    level: str
    fields: tuple[str, ...]
    when: str


@cache
def log_events() -> Mapping[str, LogEvent]:
    """All events by name."""
    text = files("edgevox.ops.logs").joinpath("events.toml").read_text(encoding="utf-8")
    return TypeAdapter(dict[str, LogEvent]).validate_python(tomllib.loads(text))
