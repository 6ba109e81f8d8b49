"""Runs the full-screen terminal on the main thread."""

from collections.abc import Sequence

from edgevox.apps.ending import Ending
from edgevox.apps.parts import Parts
from edgevox.apps.terminal.commands import Desk
from edgevox.apps.tui.face import Face
from edgevox.apps.tui.feed import Feed
from edgevox.apps.tui.screen import stderr_as_lines
from edgevox.core.clock import SystemClock

COLUMNS = 46
"""How wide a map fits beside the panel on a screen of 80 columns."""


def run_tui(parts: Parts, ending: Ending, typed: Sequence[str] = ()) -> None:
    """Serve the person at the terminal until they leave, or a signal says so.

    What was `typed` before it was drawn is done first.
    """
    feed = Feed(parts.bus, parts.controls)
    desk = Desk(parts.conversation, parts.body, columns=COLUMNS)
    face = Face(feed, desk, parts.queries, parts.switchboard.submit, SystemClock(), typed=typed)
    ending.gently = face.leave_soon
    try:
        with stderr_as_lines(lambda line: feed.write(f"! {line}")):
            face.run()
    finally:
        ending.gently = None
        feed.changed = lambda: None
        feed.close()
