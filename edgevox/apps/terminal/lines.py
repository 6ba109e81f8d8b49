"""Lines of a pipe or a file as they arrive: a stop is told at once, ahead of all waiting lines."""

import os
import select
import threading
from collections import deque
from collections.abc import Callable, Sequence

from edgevox.core.motion.interlock import Interlock

MAX_LINE_BYTES = 1 << 20
"""A line is read up to this length; what follows is a line of its own."""
MAX_AHEAD_BYTES = 1 << 20
"""The most bytes that may wait to be done; lines beyond them stay unread, even a stop."""
_READ_BYTES = 1 << 16


class Splitter:
    """Bytes in, whole lines out: bytes that are not UTF-8 become replacement characters."""

    def __init__(self) -> None:
        self._rest = b""

    def add(self, data: bytes) -> list[str]:
        """The lines that are complete with this; with no data, what is left is the last one."""
        *whole, self._rest = (self._rest + data).split(b"\n")
        if self._rest and not data:
            whole.append(self._rest)
            self._rest = b""
        while len(self._rest) >= MAX_LINE_BYTES:
            whole.append(self._rest[:MAX_LINE_BYTES])
            self._rest = self._rest[MAX_LINE_BYTES:]
        return [line.decode("utf-8", errors="replace").rstrip("\r") for line in whole]


def after_last_stop(lines: Sequence[str], is_stop: Callable[[str], bool]) -> int:
    """Return how many of these lines the last stop ends, itself included; 0 without one."""
    stops = (number for number, line in enumerate(lines, 1) if is_stop(line))
    return max(stops, default=0)


class InputLines:
    """Reads a file descriptor on its own thread, from `start` to `close`.

    `is_stop` says which lines cannot wait. Lines that are there at one moment are read together:
    those before the last stop among them, and all that wait from earlier, are forgotten, and
    `on_stop` gets the stop line and their number, on the reading thread.

    Other sources may also stop the robot. Each line has the interlock's mark from the time when
    there was last nothing to read, so a line that was written before such a stop has an older mark.
    """

    def __init__(
        self,
        fd: int,
        *,
        is_stop: Callable[[str], bool],
        on_stop: Callable[[str, int], None],
        interlock: Interlock,
    ) -> None:
        self._fd = fd
        self._interlock = interlock
        self._marking = threading.Lock()
        self._mark = interlock.mark
        self._takes = 0
        self._is_stop, self._on_stop = is_stop, on_stop
        self._splitter = Splitter()
        self._changed = threading.Condition()
        self._waiting: deque[tuple[str, int]] = deque()
        self._ended = False
        self._closed = False
        self._wake_out, self._wake_in = os.pipe()
        self._thread = threading.Thread(target=self._read, name="edgevox-lines")
        self.count = 0
        """The number of lines so far."""
        interlock.on_stop(self._stopped)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Read no more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        os.write(self._wake_in, b"x")
        if self._thread.is_alive():
            self._thread.join()
        os.close(self._wake_in)
        os.close(self._wake_out)

    def take(self, begin: Callable[[str, int], None]) -> str | None:
        """Wait for the next line and begin it; the line, or None after the last one.

        `begin` is given its mark, too. It must not block: no stop is told while it works, so none
        can come between a line and its beginning.
        """
        self._takes = threading.get_ident()
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ended)
            if not self._waiting:
                return None
            line, mark = self._waiting.popleft()
            self._changed.notify_all()
            begin(line, mark)
            return line

    def keep(self) -> None:
        """A line that was taken has stopped the robot: what waits comes after that stop."""
        mark = self._interlock.mark
        with self._changed:
            self._waiting = deque((line, mark) for line, _ in self._waiting)
        self._raise(mark)

    def _stopped(self, mark: int) -> None:
        """React to a stop, or its release, on any thread; the interlock is at `mark`."""
        if self._closed:
            return
        if threading.get_ident() in (self._takes, self._thread.ident):
            self.keep()
        elif not self._has_more():
            self._raise(mark)

    def _has_more(self) -> bool:
        return bool(select.select([self._fd], [], [], 0.0)[0])

    def _raise(self, mark: int) -> None:
        with self._marking:
            self._mark = max(self._mark, mark)

    def _read(self) -> None:
        try:
            mark = self._mark
            while self._may_read():
                mark = self._mark  # before the bytes are gone: `_stopped` sees them, or this
                if not (data := os.read(self._fd, _READ_BYTES)):
                    break
                self._arrived(self._splitter.add(data), mark)
            self._arrived(self._splitter.add(b""), mark)
        finally:
            with self._changed:
                self._ended = True
                self._changed.notify_all()

    def _may_read(self) -> bool:
        """Wait for something to read and for room; False once it is closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._has_room())
        mark = self._interlock.mark
        if not self._closed and not self._has_more():
            self._raise(mark)
            select.select([self._fd, self._wake_out], [], [])
        return not self._closed

    def _has_room(self) -> bool:
        return sum(len(line) for line, _ in self._waiting) < MAX_AHEAD_BYTES

    def _arrived(self, lines: Sequence[str], mark: int) -> None:
        over = after_last_stop(lines, self._is_stop)
        with self._changed:
            self.count += len(lines)
            if over:
                dropped = len(self._waiting) + over - 1
                self._waiting.clear()
                self._on_stop(lines[over - 1], dropped)
                mark = self._mark  # which this stop has raised
            self._waiting.extend((line, mark) for line in lines[over:])
            self._changed.notify_all()


def typed_ahead(fd: int, is_stop: Callable[[str], bool]) -> list[str]:
    """The lines that a terminal has ready, from the last stop among them on.

    What was typed before that stop is forgotten: it must not move the robot for a moment. A line
    that is not ended yet stays for the prompt.
    """
    splitter, lines = Splitter(), list[str]()
    while select.select([fd], [], [], 0.0)[0] and (data := os.read(fd, MAX_LINE_BYTES)):
        lines += splitter.add(data)
    return lines[max(0, after_last_stop(lines, is_stop) - 1) :]
