"""The full-screen terminal: the transcript as it streams, and what goes on beside it."""

from edgevox.apps.tui.face import run_tui

__all__ = ["run_tui"]
