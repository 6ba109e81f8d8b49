"""The handler that writes lines, and waits for nobody: a robot must not stop for its logs."""

import contextlib
import json
import logging
import os
import select
from io import UnsupportedOperation
from typing import TextIO

from edgevox.core.log import Line

PATIENCE_S = 0.1
"""So long a line waits for a reader that is behind. Lines are lost until it reads on."""


class LineStream(logging.Handler):
    """Writes to `stream`. Where that is a pipe whose reader has stopped, lines are dropped.

    They are counted, and the count is written when the reader goes on.
    """

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream
        self._stalled = False
        self._poll = _poll_of(stream)
        self.lost = 0

    def in_colour(self) -> bool:
        """Whether it is a terminal at this moment; the full screen puts a pipe in its place."""
        return _is_terminal(self._stream) and "NO_COLOR" not in os.environ

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line, or lose it."""
        try:
            text = self.format(record)
            if not self._writable():
                self.lost += 1
                return
            if self.lost:
                lost, self.lost = self.lost, 0
                self._write(self.format(_lost(lost)))
            self._write(text)
        except Exception:  # noqa: BLE001 - told by handleError, as logging does
            self.handleError(record)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - logging's name
        """A line that cannot be written must not stop who wrote it; try to say which it was."""
        at = f"{record.name}:{record.lineno}"
        told = {"level": "error", "logger": __name__, "event": "log_line_broken", "at": at}
        with contextlib.suppress(Exception):
            self._write(json.dumps(told))

    def _write(self, text: str) -> None:
        self._stream.write(text + "\n")
        self._stream.flush()

    def _writable(self) -> bool:
        if self._poll is None:
            return True
        wait_s = 0.0 if self._stalled else PATIENCE_S
        events = self._poll.poll(wait_s * 1000)
        self._stalled = not events
        return bool(events)


def _poll_of(stream: TextIO) -> "select.poll | None":
    """What tells whether the stream takes more; None where there is no file behind it."""
    try:
        number = stream.fileno()
    except (OSError, ValueError, UnsupportedOperation):
        return None
    poll = select.poll()
    poll.register(number, select.POLLOUT)
    return poll


def _is_terminal(stream: TextIO) -> bool:
    try:
        return os.isatty(stream.fileno())
    except (OSError, ValueError, UnsupportedOperation):
        return False


def _lost(lines: int) -> logging.LogRecord:
    about = {"name": __name__, "levelno": logging.WARNING, "levelname": "WARNING"}
    line = Line(event="log_lines_lost", lines=lines)
    return logging.makeLogRecord({**about, "msg": line, "_logger": None, "_name": "warning"})
