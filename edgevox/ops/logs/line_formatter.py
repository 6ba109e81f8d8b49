"""How a line looks: as a JSON object, or for a person at a terminal.

Every record becomes the same fields in the same order, ours and those of libraries: ``ts``,
``level``, ``logger``, ``event``, then ``turn`` and ``goal`` where it belongs to one, then its own.

What may stand in a line: plain, finite, of one line, not endless, and nobody's words.
"""

import json
import logging
import math
import traceback
from collections.abc import Callable, Iterable, Mapping, MutableMapping
from datetime import UTC, datetime
from types import TracebackType
from typing import Any

from structlog.contextvars import get_contextvars
from structlog.dev import ConsoleRenderer, plain_traceback

from edgevox.core.files.text import one_line, printable
from edgevox.core.log import LogLine, Said

MOST_CHARACTERS = 8000
"""Longer values are cut in their middle: container engines break lines at 16 KiB."""
_MOST_ITEMS = 64
_INDENT = "  "

ExcInfo = tuple[type[BaseException], BaseException, TracebackType | None]


def plain(value: object, *, speech: bool) -> Any:
    """The value as JSON takes it. What somebody said becomes its length, unless `speech`."""
    if isinstance(value, str):  # first, as most values are
        return cut(value)
    if value is None or isinstance(value, int):  # a bool is one, too
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, Said):
        return cut(value.text) if speech else repr(value)
    if isinstance(value, Mapping):
        pairs = list(value.items())[:_MOST_ITEMS]
        return {str(name): plain(one, speech=speech) for name, one in pairs}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(one, speech=speech) for one in list(value)[:_MOST_ITEMS]]
    return cut(str(value))


def cut(text: str) -> str:
    """Not endless."""
    if len(text) <= MOST_CHARACTERS:
        return text
    half = MOST_CHARACTERS // 2
    return f"{text[:half]} ... {text[-half:]}"


def trace(error: ExcInfo) -> str:
    """A traceback, its last lines if it is endless.

    Its lines stand further in: what an exception quotes never looks like a line of the log.
    """
    text = cut("".join(_lines(error)).rstrip())
    return "\n".join(f"{_INDENT}{line}" for line in printable(text).split("\n"))


def _lines(error: ExcInfo) -> Iterable[str]:
    kind, value, where = error
    return traceback.format_exception(kind, value, where)


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
