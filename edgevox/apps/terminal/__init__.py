"""The terminal as a face of EdgeVox: events become lines, lines become commands."""

from edgevox.apps.terminal.run_terminal import run_terminal

__all__ = ["run_terminal"]
