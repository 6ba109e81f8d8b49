"""Where a program's lines leave the process: a disk may be full, a reader gone or asleep.

A program works on when its lines cannot be written, so nothing here raises or waits for long.
Imports nothing that is slow to import.
"""

import io
import os
import select
import stat
from collections.abc import Callable
from typing import Any

PATIENCE_S = 0.1
"""So long a line waits for a reader that is behind. Lines are lost until it reads on."""
ASLEEP = "its reader does not read"

Tell = Callable[[OSError], None]


class OutputReader:
    """Who reads what is written to a file descriptor; a file has one that is always awake."""

    def __init__(self, number: int) -> None:
        self._poll = select.poll()
        self._poll.register(number, select.POLLOUT)
        self._asleep = False

    def awake(self) -> bool:
        """Whether there is room for a piece of `select.PIPE_BUF` bytes, now or very soon."""
        wait_s = 0.0 if self._asleep else PATIENCE_S
        events = self._poll.poll(wait_s * 1000)
        self._asleep = not events
        return bool(events)


class OutputStream(io.RawIOBase):
    """Writes to a file descriptor, and takes as written what cannot be.

    `tell` is told why, once, and again only after something could be written meanwhile. One that
    `waits` does so for a reader who is behind, as programs do whose output is what they are for.
    The descriptor stays open when this is closed.
    """

    def __init__(self, number: int, tell: Tell, *, waits: bool) -> None:
        super().__init__()
        self._number = number
        self._tell = tell
        self._told = False
        mode = os.fstat(number).st_mode
        flows = stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)
        self._most = select.PIPE_BUF if flows else io.DEFAULT_BUFFER_SIZE
        self._reader = None if waits or not flows else OutputReader(number)

    def fileno(self) -> int:
        return self._number

    def isatty(self) -> bool:
        return os.isatty(self._number)

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        """How much was taken; all of it where nothing can be written."""
        piece = bytes(memoryview(data)[: self._most])
        try:
            if self._reader and not self._reader.awake():
                raise OSError(ASLEEP)
            written = os.write(self._number, piece)
        except OSError as error:
            if not self._told:
                self._told = True
                self._tell(error)
            return len(data)
        self._told = False
        return written
