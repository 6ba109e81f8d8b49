"""The terminal as a face of EdgeVox: events become lines, lines become commands.

`prompt` and `screen` are for a person; `run_terminal` chooses, and reads a pipe.
"""

from edgevox.apps.terminal.run_terminal import run_terminal

__all__ = ["run_terminal"]
