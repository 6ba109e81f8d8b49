"""The full-screen terminal, run on the main thread."""

import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.shutdown_signals import ShutdownSignals
from edgevox.apps.terminal.slash_commands import SlashContext
from edgevox.apps.tui.face import Face
from edgevox.apps.tui.update_buffer import UpdateBuffer
from edgevox.core.clock import SystemClock


@contextmanager
def stderr_as_lines(write: Callable[[str], None]) -> Iterator[None]:
    """While entered, lines that are written to stderr go to `write`, on a thread of its own.

    Textual draws on ``sys.__stderr__``, which stays the terminal.
    """
    terminal, original = os.dup(2), sys.__stderr__
    reading, writing = os.pipe()
    os.dup2(writing, 2)
    os.close(writing)
    sys.__stderr__ = os.fdopen(os.dup(terminal), "w", encoding="utf-8")  # type: ignore[misc]

    def carry() -> None:
        with os.fdopen(reading, encoding="utf-8", errors="replace") as lines:
            for line in lines:
                write(line.rstrip())

    thread = threading.Thread(target=carry, name="edgevox-stderr")
    thread.start()
    try:
        yield
    finally:
        os.dup2(terminal, 2)  # the last way into the pipe is gone with this
        os.close(terminal)
        thread.join()
        sys.__stderr__.close()
        sys.__stderr__ = original  # type: ignore[misc]


COLUMNS = 46
"""The width of a map beside the panel on a screen of 80 columns."""


def run_tui(parts: AgentParts, shutdown: ShutdownSignals, typed: Sequence[str] = ()) -> None:
    """Serve the person at the terminal until they leave, or a signal says so.

    What was `typed` before it was drawn is done first.
    """
    updates = UpdateBuffer(parts.bus, parts.controls)
    for note in parts.notes:
        updates.write(note)
    context = SlashContext(parts.conversation, parts.body, columns=COLUMNS, skills=parts.skills)
    face = Face(
        updates, context, parts.queries, parts.command_router.submit, SystemClock(), typed=typed
    )
    shutdown.gently = face.leave_soon
    try:
        with stderr_as_lines(updates.log):
            face.run()
    finally:
        shutdown.gently = None
        updates.changed = lambda: None
        updates.close()
