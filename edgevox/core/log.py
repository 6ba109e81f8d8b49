"""Loggers: every module writes the name of an event, then its fields.

    log = get_logger(__name__)
    log.warning("sound_device_lost", device=name, retry_s=2.0)

Lines go through the standard library's logging, under the module's name. `edgevox.ops.logs` sets up
their form and their destination; without a setup, nothing is shown.
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
"""Number of frames from `_proxy_to_logger` up to the caller; `info` is between them."""

logging.getLogger(ROOT).addHandler(logging.NullHandler())  # else warnings print by themselves


class Said:
    """Words of a person or the robot for a log field, printed only as their length.

    Wrap such words in this class, so that no line shows them by accident. `text` has the words.
    """

    __slots__ = ("text",)

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return f"<{len(self.text)} characters>"


def worth_a_line(count: int) -> bool:
    """True for the failures 1, 2, 4, 8, ..., so that a flood leaves only a few lines.

    This thins failures that go on all night; `RateLimit` of `edgevox.ops.logs` thins fast ones.
    """
    return count.bit_count() == 1


class ChangeDetector:
    """Tells whether texts differ from the last ones, so that a lasting fault is one line."""

    def __init__(self) -> None:
        self._said: tuple[str, ...] = ()

    def __call__(self, *told: str) -> bool:
        """True if the texts differ from those of the last call."""
        news, self._said = told != self._said, told
        return news


class LogLine(dict[str, Any]):
    """An event and its fields, as a log record's message; reads ``event field=value ...``."""

    def __str__(self) -> str:
        fields = (f"{name}={value!r}" for name, value in self.items() if name != "event")
        return " ".join((str(self.get("event", "")), *fields))


class Logger(BoundLogger):
    """structlog's logger on top of the standard library's; a line below its level costs nothing.

    It makes the record itself instead of using structlog's processors and logging's search for the
    caller, which together are a third of a line's cost before it is written.
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
    """The logger of a module, whose lines have an event and named fields."""
    return Logger(logging.getLogger(name), [], {})


@contextmanager
def bound(**ids: object) -> Iterator[None]:
    """Add fields such as ``turn=3`` or ``goal="7"`` to every line of this thread meanwhile.

    A field that is None, 0 or empty is left out: there is no such turn or goal.
    """
    with bound_contextvars(**{name: value for name, value in ids.items() if value}):
        yield


def bound_now() -> dict[str, Any]:
    """The bound fields of this thread, to bind in another thread that works for the same turn."""
    return get_contextvars()


def _exc_info(told: Any) -> Any:
    """The exception that `exc_info` means, as in logging: a given one, or the one handled now."""
    if not told or isinstance(told, tuple):
        return told or None
    if isinstance(told, BaseException):
        return type(told), told, told.__traceback__
    return sys.exc_info()
