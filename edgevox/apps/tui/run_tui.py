"""Runs the full-screen terminal on the main thread."""

from collections.abc import Sequence

from edgevox.apps.agent_parts import AgentParts
from edgevox.apps.shutdown_signals import ShutdownSignals
from edgevox.apps.terminal.slash_commands import SlashContext
from edgevox.apps.tui.face import Face
from edgevox.apps.tui.screen import stderr_as_lines
from edgevox.apps.tui.update_buffer import UpdateBuffer
from edgevox.core.clock import SystemClock

COLUMNS = 46
"""How wide a map fits beside the panel on a screen of 80 columns."""


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
