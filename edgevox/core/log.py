"""Logs, as every module writes them: the name of an event, then its fields.

    log = get_logger(__name__)
    log.warning("sound_device_lost", device=name, retry_s=2.0)

Lines go through the standard library's logging, under the module's name. How they look and where
they go is set up by `edgevox.ops.logs`; where nobody sets anything up, nothing is shown.
"""

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from structlog.contextvars import bound_contextvars, get_contextvars
from structlog.stdlib import BoundLogger

ROOT = "edgevox"
"""The logger above all of ours."""

_LEVELS = {
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warning": logging.WARNING,
    "error": logging.ERROR,
    "exception": logging.ERROR,
    "critical": logging.CRITICAL,
}
_CALLER = 2
"""How many frames above `_proxy_to_logger` the line was written: `info` is between them."""

logging.getLogger(ROOT).addHandler(logging.NullHandler())  # else warnings print by themselves


class Said:
    """What a person or the robot said. It prints as its length; `text` is the words themselves.

    A field that holds such words is given as this, so that no line shows them by accident.
    """

    __slots__ = ("text",)

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return f"<{len(self.text)} characters>"


def worth_a_line(count: int) -> bool:
    """Whether the failure of this number is one of 1, 2, 4, 8, ...: a flood leaves a few lines.

    `RateLimit` of `edgevox.ops.logs` thins what comes fast; this what goes on all night.
    """
    return count.bit_count() == 1


class ChangeDetector:
    """Says whether something differs from what was told last: a fault that stays is one line."""

    def __init__(self) -> None:
        self._said: tuple[str, ...] = ()

    def __call__(self, *told: str) -> bool:
        """Whether it is worth a line; from now on this is what was told last."""
        news, self._said = told != self._said, told
        return news


class LogLine(dict[str, Any]):
    """An event and its fields, as a log record's message; reads ``event field=value ...``."""

    def __str__(self) -> str:
        fields = (f"{name}={value!r}" for name, value in self.items() if name != "event")
        return " ".join((str(self.get("event", "")), *fields))


class Logger(BoundLogger):
    """structlog's logger on top of the standard library's; a line below its level costs nothing.

    It makes the record by itself, in place of structlog's processors and logging's search for the
    caller: together a third of what a line costs before it is written.
    """

    def _proxy_to_logger(
        self, method_name: str, event: str | None = None, *event_args: str, **event_kw: Any
    ) -> None:
        logger, level = self._logger, _LEVELS[method_name]
        if not logger.isEnabledFor(level):
            return
        if event_args:
            raise TypeError(f"{event}: got positional arguments, expected fields by name")
        error = _exc_info(event_kw.pop("exc_info", None))
        line = LogLine(get_contextvars())
        line.update(self._context, **event_kw, event=event)
        frame = sys._getframe(_CALLER)  # noqa: SLF001 - as logging does it
        code = frame.f_code
        logger.handle(
            logger.makeRecord(
                logger.name, level, code.co_filename, frame.f_lineno, line, (), error, code.co_name
            )
        )


def get_logger(name: str) -> Logger:
    """The logger of a module: its lines have an event and fields, by name."""
    return Logger(logging.getLogger(name), [], {})


@contextmanager
def bound(**ids: object) -> Iterator[None]:
    """Put these, such as ``turn=3`` or ``goal="7"``, on every line of this thread meanwhile.

    One that is None, 0 or empty is left out: there is no such turn or goal.
    """
    with bound_contextvars(**{name: value for name, value in ids.items() if value}):
        yield


def bound_now() -> dict[str, Any]:
    """What this thread has bound: another that works for the same turn binds it, too."""
    return get_contextvars()


def _exc_info(told: Any) -> Any:
    """What `exc_info` means, as logging has it: an exception, or the one that is handled now."""
    if not told or isinstance(told, tuple):
        return told or None
    if isinstance(told, BaseException):
        return type(told), told, told.__traceback__
    return sys.exc_info()
