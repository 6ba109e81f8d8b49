"""The output stream of a program, which survives a full disk and a reader that is gone or slow.

A program works on if its lines cannot be written, so nothing here raises or waits for long.
Imports nothing that is slow to import.
"""

import io
import os
import select
import stat
from collections.abc import Callable
from typing import Any

PATIENCE_S = 0.1
"""Seconds that a line waits for a slow reader; after that, lines are lost until it reads on."""
ASLEEP = "its reader does not read"

Tell = Callable[[OSError], None]


class OutputReader:
    """The reader at the other end of a file descriptor."""

    def __init__(self, number: int) -> None:
        self._poll = select.poll()
        self._poll.register(number, select.POLLOUT)
        self._asleep = False

    def awake(self) -> bool:
        """True if there is room for `select.PIPE_BUF` bytes, now or within `PATIENCE_S`."""
        wait_s = 0.0 if self._asleep else PATIENCE_S
        events = self._poll.poll(wait_s * 1000)
        self._asleep = not events
        return bool(events)


class OutputStream(io.RawIOBase):
    """Writes to a file descriptor, and drops data that cannot be written.

    `tell` gets the error once, and again only after a successful write. A stream with `waits` waits
    for a slow reader; that suits programs whose purpose is their output. Closing the stream leaves
    the descriptor open.
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
        """Write data and return the number of bytes taken; all bytes if writing fails."""
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
