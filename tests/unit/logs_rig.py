"""A program's log, written to memory and read back."""

import io
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from edgevox.core.settings import Settings
from edgevox.ops.logs import set_up, tear_down


class Logged:
    """What was written, as text and as the objects of a JSON log."""

    def __init__(self) -> None:
        self.stream = io.StringIO()

    @property
    def text(self) -> str:
        return self.stream.getvalue()

    @property
    def lines(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.text.splitlines()]

    def of(self, event: str) -> list[dict[str, Any]]:
        return [line for line in self.lines if line["event"] == event]


@contextmanager
def logging_to_memory(**settings: Any) -> Iterator[Logged]:
    """Log as a program does, meanwhile."""
    logged = Logged()
    set_up(Settings(**{"log_format": "json", "log_level": "info", **settings}), logged.stream)
    try:
        yield logged
    finally:
        tear_down()
