"""Chooses how to talk: a prompt on a terminal, a script from a pipe, or nobody at all."""

import contextlib
import os
import stat
import sys
import threading

from edgevox.apps.ending import Ending
from edgevox.apps.terminal.commands import Desk
from edgevox.apps.terminal.prompt import Prompt
from edgevox.apps.terminal.script import run_script
from edgevox.apps.terminal.view import View
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock


def run_terminal(bus: Bus, desk: Desk, ending: Ending, *, plain: bool = False) -> None:
    """Serve whoever is at stdin, on the main thread, until they leave.

    A terminal gets a prompt (a bare line reader if `plain`). A pipe or a file is a script: it ends
    the program when its last line is done. An empty stdin, or none, is nobody: the program runs
    until it is told to end by a signal.
    """
    if _is_terminal() and not plain:
        Prompt(bus, desk, SystemClock()).run(ending)
        return
    if _has_input() and run_script(sys.stdin.buffer, bus, desk, _write):
        return
    view = View(bus, _write)
    try:
        threading.Event().wait()
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
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode) or stat.S_ISSOCK(mode) or sys.stdin.isatty()


def _write(line: str) -> None:
    with contextlib.suppress(
        BrokenPipeError
    ):  # whoever read our output has left; the robot has not
        print(line, flush=True)
