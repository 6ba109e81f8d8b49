"""How a line looks: as a JSON object, or for a person at a terminal.

Every record becomes the same fields in the same order, ours and those of libraries: ``ts``,
``level``, ``logger``, ``event``, then ``turn`` and ``goal`` where it belongs to one, then its own.
"""

import json
import logging
import math
from collections.abc import Callable, MutableMapping
from datetime import UTC, datetime
from typing import Any

from structlog.contextvars import get_contextvars
from structlog.dev import ConsoleRenderer, plain_traceback

from edgevox.core.log import LogLine
from edgevox.core.text import one_line
from edgevox.ops.logs.values import plain, trace

Fields = MutableMapping[str, Any]
Render = Callable[[Any, str, Fields], str | bytes]

IDS = ("turn", "goal")
"""The fields that say what a line belongs to."""
LAST = "exception"
_EVENT_WIDTH = 24


class LineFormatter(logging.Formatter):
    """Makes the fields of a record, ours or a library's, and gives them to structlog's renderers.

    In place of structlog's `ProcessorFormatter`, which copies each record for processors that may
    change it: that took a fifth of what a line costs, and nothing here changes one.
    """

    def __init__(self, stamp: Callable[[float], str], render: Render, *, speech: bool) -> None:
        super().__init__()
        self._stamp, self._render, self._speech = stamp, render, speech

    def format(self, record: logging.LogRecord) -> str:
        """One line."""
        fields = _fields(record)
        shows = self._speech or record.levelno <= logging.DEBUG
        told: Fields = {
            "ts": self._stamp(record.created),
            "level": record.levelname.lower(),
            "logger": record.name,
            "event": plain(fields.get("event", ""), speech=shows),
        }
        for name in IDS:
            if name in fields:
                told[name] = fields[name]
        for name, value in fields.items():
            if name not in told:
                told[name] = plain(value, speech=shows)
        if record.exc_info and record.exc_info[0]:
            told[LAST] = trace(record.exc_info)
        return str(self._render(None, record.levelname, told))


def json_lines(*, speech: bool) -> LineFormatter:
    """One JSON object a line, in UTF-8."""
    encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode

    def render(_logger: object, _method: str, fields: Fields) -> str:
        return _json_coded(encode(fields))

    return LineFormatter(_UtcStamp(), render, speech=speech)


def console_lines(*, speech: bool, in_colour: Callable[[], bool]) -> LineFormatter:
    """For people; `in_colour` is asked for every line, since a screen may come and go."""
    coloured, bare = _console(colors=True), _console(colors=False)

    def render(logger: object, method: str, fields: Fields) -> str:
        error = fields.pop(LAST, None)
        shown = {name: _shown(value) for name, value in fields.items()}
        shown["timestamp"] = shown.pop("ts")
        line = (coloured if in_colour() else bare)(logger, method, shown)
        return f"{line}\n{error}" if error else str(line)

    return LineFormatter(_time_of_day, render, speech=speech)


def _fields(record: logging.LogRecord) -> Fields:
    """What it says: an event with its fields, or a library's text with what its thread is about."""
    if isinstance(record.msg, LogLine):
        return record.msg
    told = {**get_contextvars(), "event": record.getMessage()}
    return {**told, "stack_info": record.stack_info} if record.stack_info else told


def _console(*, colors: bool) -> ConsoleRenderer:
    return ConsoleRenderer(
        colors=colors,
        pad_event_to=_EVENT_WIDTH,
        sort_keys=False,
        exception_formatter=plain_traceback,
    )


def _json_coded(text: str) -> str:
    """The same JSON with what would steer a terminal in JSON's own code: `jq -r` has it back."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else json.dumps(one)[1:-1] for one in text)


def _shown(value: Any) -> Any:
    return one_line(value) if isinstance(value, str) else value


class _UtcStamp:
    """The time of a line. Lines come close together: the text of a second is kept."""

    def __init__(self) -> None:
        self._kept = (0, "")

    def __call__(self, created_s: float) -> str:
        second, part_ms = divmod(math.floor(created_s * 1000), 1000)
        kept_second, text = self._kept
        if second != kept_second or not text:
            text = datetime.fromtimestamp(second, UTC).strftime("%Y-%m-%dT%H:%M:%S")
            self._kept = (second, text)
        return f"{text}.{part_ms:03d}Z"


def _time_of_day(created_s: float) -> str:
    local = datetime.fromtimestamp(created_s, UTC).astimezone()
    return local.time().isoformat(timespec="milliseconds")
