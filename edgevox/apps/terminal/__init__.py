"""The terminal as a face of EdgeVox: events become lines, lines become commands.

`prompt` and `screen` are for a person, `lines` reads a pipe, `run_terminal` chooses.
"""

from edgevox.apps.terminal.run_terminal import run_terminal

__all__ = ["run_terminal"]
