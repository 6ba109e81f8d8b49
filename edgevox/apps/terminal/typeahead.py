"""What a person typed before there was a prompt: it waits in the terminal, a stop among it."""

import os
import select
from collections.abc import Callable

from edgevox.apps.terminal.lines import MAX_LINE_BYTES, Splitter, after_last_stop


def typed_ahead(fd: int, is_stop: Callable[[str], bool]) -> list[str]:
    """The lines that a terminal has ready, from the last stop among them on.

    What was typed before that stop is forgotten: it must not move the robot for a moment. A line
    that is not ended yet stays for the prompt.
    """
    splitter, lines = Splitter(), list[str]()
    while select.select([fd], [], [], 0.0)[0] and (data := os.read(fd, MAX_LINE_BYTES)):
        lines += splitter.add(data)
    return lines[max(0, after_last_stop(lines, is_stop) - 1) :]
