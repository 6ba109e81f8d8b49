"""Lines from a pipe or a file, one after another, each done before the next."""

from collections.abc import Callable
from typing import BinaryIO

from edgevox.apps.terminal.commands import Desk, Leave, run_command
from edgevox.apps.terminal.view import View
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.text import MAX_CHARACTERS

MAX_LINE_BYTES = 1 << 20
"""A line is read up to this length; what follows is a line of its own."""


def run_script(lines: BinaryIO, bus: Bus, desk: Desk, write: Callable[[str], None]) -> int:
    """Submit every line and wait until it is answered and done. How many lines there were.

    Bytes that are not UTF-8 become replacement characters; the line is still answered.
    """
    view = View(bus, write)
    count = 0
    try:
        while raw := lines.readline(MAX_LINE_BYTES):
            count += 1
            line = raw.decode("utf-8", errors="replace").rstrip("\r\n")
            write(f"> {line[:MAX_CHARACTERS]}")
            if line.startswith("/"):
                write(run_command(line, desk))
                continue
            view.expect(line)
            desk.conversation.submit(TextInput(line))
            desk.conversation.wait_idle()
    except Leave:
        pass
    finally:
        view.close()
    return count
