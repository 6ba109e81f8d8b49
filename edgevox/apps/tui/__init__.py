"""The full-screen terminal: the transcript as it streams, and what goes on beside it."""

from edgevox.apps.tui.run_tui import run_tui

__all__ = ["run_tui"]
