"""The handler that writes lines, and waits for nobody: a robot must not stop for its logs.

It is our own, because behind a `logging.handlers.QueueHandler` the listener's thread would wait for
a reader that has stopped: lines would pile up or vanish uncounted, the program's end would wait for
that thread, and the last lines before a crash would still be in the queue.
"""

import contextlib
import json
import logging
import os
from io import UnsupportedOperation
from typing import TextIO

from edgevox.core.log import LogLine
from edgevox.core.output_stream import OutputReader


class LineStream(logging.Handler):
    """Writes to `stream`. Where that is a pipe whose reader has stopped, lines are dropped.

    They are counted, and the count is written when the reader goes on.
    """

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream
        self._reader = _reader_of(stream)
        self.lost = 0

    def in_colour(self) -> bool:
        """Whether it is a terminal at this moment; the full screen puts a pipe in its place."""
        return _is_terminal(self._stream) and "NO_COLOR" not in os.environ

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line, or lose it."""
        try:
            text = self.format(record)
            if self._reader and not self._reader.awake():
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


def _reader_of(stream: TextIO) -> OutputReader | None:
    """Who reads the stream; None where there is no file behind it."""
    try:
        return OutputReader(stream.fileno())
    except (OSError, ValueError, UnsupportedOperation):
        return None


def _is_terminal(stream: TextIO) -> bool:
    try:
        return os.isatty(stream.fileno())
    except (OSError, ValueError, UnsupportedOperation):
        return False


def _lost(lines: int) -> logging.LogRecord:
    about = {"name": __name__, "levelno": logging.WARNING, "levelname": "WARNING"}
    line = LogLine(event="log_lines_lost", lines=lines)
    return logging.makeLogRecord({**about, "msg": line})
