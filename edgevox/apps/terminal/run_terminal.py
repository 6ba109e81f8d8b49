"""The choice of the terminal's mode: a prompt, a script from a pipe, or none.

Lines of a pipe are read as they arrive: a stop is told at once, ahead of all waiting lines.
"""

import os
import select
import stat
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence

from edgevox.agent.skills import STOP
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_stop, run_command
from edgevox.apps.terminal.view import View
from edgevox.core.agent_events import GoalChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput, Way
from edgevox.core.motion.interlock import Interlock
from edgevox.voice.sources.open_source import WavFiles

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

        `begin` also gets its mark. It must not block: no stop is told while it works, so none
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


def run_script(
    fd: int, bus: Bus, context: SlashContext, write: Callable[[str], None], interlock: Interlock
) -> int:
    """Submit every line and wait until it is answered and done. Return the number of lines.

    A stop line acts when it is read, and the lines that wait before it are dropped; so are lines
    that wait when another source stops the robot.
    """
    view = View(bus, write)

    def begin(line: str, mark: int) -> None:
        if line.startswith("/"):
            return
        if interlock.outdated(mark):
            write(f"  [not done, the robot was stopped: {line}]")
        context.conversation.submit(TextInput(line, Way.TYPED), mark)

    def run_slash(line: str) -> None:
        if line.startswith("/"):
            answer = run_command(line, context)
            write(f"> {line}\n{answer}")

    def stop(line: str, dropped: int) -> None:
        begin(line, interlock.mark)
        run_slash(line)
        if dropped:
            write(f"  [cancelled lines before this stop: {dropped}]")

    def keep(event: GoalChanged) -> None:
        """Keep the lines behind one that calls the skill `stop` in words: they come after it."""
        if event.skill == STOP and event.turn:
            lines.keep()

    lines = InputLines(
        fd, is_stop=lambda line: is_stop(line, context), on_stop=stop, interlock=interlock
    )
    forget = bus.subscribe(GoalChanged, keep)
    lines.start()
    try:
        while (line := lines.take(begin)) is not None:
            run_slash(line)
            context.conversation.wait_idle()
        context.conversation.wait_idle()  # for the answer to a stop that was the last line
    except Leave:
        pass
    finally:
        forget()
        lines.close()
        view.close()
    return lines.count


_LOOK_S = 1.0
"""The longest sleep of the main thread: a signal that comes just before the sleep, after
Python's check, is seen at the wake-up."""


def run_terminal(parts: AgentParts, shutdown: ShutdownSignals) -> None:
    """Serve whoever is at stdin, on the main thread, until they leave.

    A terminal gets the whole screen, or a prompt if `simple_ui` is set. A pipe or a file is a
    script: it ends the program when its last line is done. An empty stdin, or none, is nobody: the
    program runs until its WAV files are over, if it hears those, or a signal tells it to end.
    """
    context = SlashContext(
        parts.conversation,
        parts.body,
        skills=parts.skills,
        software_stop=parts.software_stop,
        settings=parts.settings,
    )
    if _is_terminal():
        typed = typed_ahead(sys.stdin.fileno(), lambda line: is_stop(line.strip(), context))
        if parts.settings.simple_ui:
            from edgevox.apps.terminal.prompt import Prompt

            Prompt(parts.bus, context).run(shutdown, typed)
            return
        from edgevox.apps.terminal.screen import run_tui

        run_tui(parts, shutdown, typed)
    elif not (
        _has_input() and run_script(sys.stdin.fileno(), parts.bus, context, _write, parts.interlock)
    ):
        _run_alone(parts)


def _run_alone(parts: AgentParts) -> None:
    """Run without a terminal; show the conversation, unless the log is for programs.

    Returns at the end of a sound file; with any other source it runs until a signal.
    """
    told = parts.settings.log_format != "json"
    view = View(parts.bus, _write if told else lambda _line: None)
    try:
        if parts.listener and parts.voice and isinstance(parts.voice.source, WavFiles):
            parts.listener.wait_over()
            parts.conversation.wait_idle()
        else:
            while True:
                time.sleep(_LOOK_S)
    finally:
        view.close()


def _is_terminal() -> bool:
    return sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()


def _has_input() -> bool:
    if sys.stdin is None or sys.stdin.closed:
        return False
    try:
        mode = os.fstat(sys.stdin.fileno()).st_mode
    except OSError:
        return False
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode) or stat.S_ISSOCK(mode)


def _write(line: str) -> None:
    show(line)
