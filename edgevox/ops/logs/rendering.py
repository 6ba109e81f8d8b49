"""How a line looks: as a JSON object, or for a person at a terminal.

Every record becomes the same fields in the same order, ours and those of libraries: ``ts``,
``level``, ``logger``, ``event``, then ``turn`` and ``goal`` where it belongs to one, then its own.
"""

import json
from collections.abc import Callable, MutableMapping
from datetime import UTC, datetime
from logging import DEBUG, LogRecord
from typing import Any

from structlog.contextvars import merge_contextvars
from structlog.dev import ConsoleRenderer, plain_traceback
from structlog.processors import JSONRenderer
from structlog.stdlib import ProcessorFormatter

from edgevox.ops.logs.values import one_line, plain, trace

Fields = MutableMapping[str, Any]

FIRST = ("ts", "level", "logger", "event", "turn", "goal")
"""The fields that every line has, or that say what it belongs to. No event has its own of these."""
LAST = "exception"
_EVENT_WIDTH = 24


def json_lines(*, speech: bool) -> ProcessorFormatter:
    """One JSON object a line, in UTF-8."""
    encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
    return _formatter(speech, _utc, JSONRenderer(lambda fields, **_: encode(fields)))


def console_lines(*, speech: bool, in_colour: Callable[[], bool]) -> ProcessorFormatter:
    """For people; `in_colour` is asked for every line, since a screen may come and go."""
    coloured, bare = _console(colors=True), _console(colors=False)

    def render(logger: object, method: str, fields: Fields) -> str:
        error = fields.pop(LAST, None)
        shown = {name: _shown(value) for name, value in fields.items()}
        shown["timestamp"] = shown.pop("ts")
        line = (coloured if in_colour() else bare)(logger, method, shown)
        return f"{line}\n{error}" if error else str(line)

    return _formatter(speech, _time_of_day, render)


def _formatter(
    speech: bool, stamp: Callable[[float], str], render: Callable[[Any, str, Fields], str | bytes]
) -> ProcessorFormatter:
    def describe(_logger: object, _method: str, fields: Fields) -> Fields:
        record: LogRecord = fields.pop("_record")
        del fields["_from_structlog"]
        fields.pop("exc_info", None)
        shows = speech or record.levelno <= DEBUG
        told: Fields = {
            "ts": stamp(record.created),
            "level": record.levelname.lower(),
            "logger": record.name,
            "event": plain(fields.pop("event", ""), speech=shows),
        }
        told.update({name: fields.pop(name) for name in FIRST if name in fields})
        told.update({name: plain(value, speech=shows) for name, value in fields.items()})
        if record.exc_info and record.exc_info[0]:
            told[LAST] = trace(record.exc_info)
        record.exc_info = record.exc_text = None  # it is told; logging would add it once more
        return told

    return ProcessorFormatter(
        processors=[describe, render],
        foreign_pre_chain=[merge_contextvars],
        keep_exc_info=True,
    )


def _console(*, colors: bool) -> ConsoleRenderer:
    return ConsoleRenderer(
        colors=colors,
        pad_event_to=_EVENT_WIDTH,
        sort_keys=False,
        exception_formatter=plain_traceback,
    )


def _shown(value: Any) -> Any:
    return one_line(value) if isinstance(value, str) else value


def _utc(created_s: float) -> str:
    text = datetime.fromtimestamp(created_s, UTC).isoformat(timespec="milliseconds")
    return text.replace("+00:00", "Z")


def _time_of_day(created_s: float) -> str:
    local = datetime.fromtimestamp(created_s, UTC).astimezone()
    return local.time().isoformat(timespec="milliseconds")
