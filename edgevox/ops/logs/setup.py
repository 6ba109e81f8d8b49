"""Puts all lines of a program into one stream, and takes that back."""

import faulthandler
import logging
import sys
from collections.abc import Callable
from typing import TextIO

from edgevox.core.settings import Settings
from edgevox.ops.logs.limit import RateLimit
from edgevox.ops.logs.line_formatter import console_lines, json_lines
from edgevox.ops.logs.stream import LineStream
from edgevox.ops.logs.uncaught import catch_uncaught

_UNREAD = ("logThreads", "logProcesses", "logMultiprocessing")
"""What logging finds out for every record, unless told not to, and no line of ours shows."""


class ProgramLog(LineStream):
    """The one handler of a program's root logger, with all that `tear_down` has to undo."""

    def __init__(self, settings: Settings, stream: TextIO) -> None:
        super().__init__(stream)
        self.json = settings.log_format == "json"
        speech, colours = settings.log_speech, settings.log_format == "console"
        self.setFormatter(
            json_lines(speech=speech)
            if self.json
            else console_lines(speech=speech, in_colour=_always if colours else self.in_colour)
        )
        self.limit = RateLimit()
        self.addFilter(self.limit)
        self._level_before = logging.getLogger().level
        self._kept_before = {name: getattr(logging, name) for name in _UNREAD}
        self._undo: Callable[[], None] = lambda: None

    def open(self, level: str) -> None:
        """From now on, everything goes here."""
        root = logging.getLogger()
        root.addHandler(self)
        root.setLevel(level.upper())
        for name in _UNREAD:
            setattr(logging, name, False)
        self._undo = catch_uncaught()
        logging.captureWarnings(capture=True)

    def close(self) -> None:
        """As it was before."""
        root = logging.getLogger()
        if self in root.handlers:
            self.limit.tell()
            logging.captureWarnings(capture=False)
            self._undo()
            root.removeHandler(self)
            root.setLevel(self._level_before)
            for name, kept in self._kept_before.items():
                setattr(logging, name, kept)
        super().close()


def set_up(settings: Settings, stream: TextIO | None = None) -> None:
    """All lines of this program to stderr, as the settings say; called again, it changes that."""
    tear_down()
    ProgramLog(settings, stream or sys.stderr).open(settings.log_level)
    if stream is None and not faulthandler.is_enabled():
        _show_crashes()


def tear_down() -> None:
    """Log as a library does: it is for others to say where to."""
    for handler in _open():
        handler.close()


def is_set_up() -> bool:
    """Whether a program's lines go to one stream."""
    return bool(_open())


def writes_json() -> bool:
    """Whether it is for programs to read."""
    return any(one.json for one in _open())


def _open() -> list[ProgramLog]:
    return [one for one in logging.getLogger().handlers if isinstance(one, ProgramLog)]


def _show_crashes() -> None:
    """Where an engine in C kills the process, say which threads did what."""
    try:
        faulthandler.enable()
    except (OSError, ValueError, AttributeError):  # no stderr, or one without a file
        return


def _always() -> bool:
    return True
