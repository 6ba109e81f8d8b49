"""The interactive prompt. Ctrl-C stops the robot, as in the full-screen terminal; Ctrl-D leaves."""

import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from prompt_toolkit import PromptSession
from prompt_toolkit.application import get_app_or_none
from prompt_toolkit.formatted_text import AnyFormattedText
from prompt_toolkit.patch_stdout import patch_stdout
from prompt_toolkit.styles import Style

from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_slow, run_command
from edgevox.apps.terminal.view import View, stop_line
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, TextInput, Way
from edgevox.core.events import Cause
from edgevox.core.files.text import printable_in_colour
from edgevox.core.log import get_logger

log = get_logger(__name__)


_STYLE = Style.from_dict(
    {
        "bottom-toolbar": "noreverse fg:ansicyan",
        "prompt": "bold",
        "stopped": "bold fg:ansiwhite bg:ansired",
    }
)


class Prompt:
    """A prompt_toolkit session on the calling thread."""

    def __init__(self, bus: Bus, context: SlashContext) -> None:
        self._slash_context = context
        self._commands = ThreadPoolExecutor(1, "edgevox-commands")
        """Runs the slow ones: a stop that is typed meanwhile does not wait for them."""
        self._session: PromptSession[str] = PromptSession(
            "> ", bottom_toolbar=self._toolbar, style=_STYLE
        )
        self._view = View(bus, show, self._session.app.invalidate)

    def run(self, shutdown: ShutdownSignals, typed: Sequence[str] = ()) -> None:
        """Do the `typed` lines, then read lines until the person leaves, or a signal ends it.

        No line waits for the action of an earlier one.
        """
        from edgevox.apps.terminal.screen import stderr_as_lines

        shutdown.gently = self._leave
        try:
            with patch_stdout(raw=True), stderr_as_lines(_log_line):  # above the prompt
                going_on = all(self._take(line.strip()) for line in typed)
                while going_on and self._step():
                    pass
        finally:
            shutdown.gently = None
            self._commands.shutdown()
            self._view.close()

    def _step(self) -> bool:
        try:
            line = self._session.prompt().strip()
        except KeyboardInterrupt:
            self._interrupt()
            return True
        except EOFError:
            return False
        return self._take(line)

    def _take(self, line: str) -> bool:
        """Begin what a line says; False if the person wants to leave."""
        if is_slow(line):
            self._commands.submit(self._run_slash, line)
        elif line.startswith("/"):
            return self._run_slash(line)
        elif line:
            self._view.expect(line)
            self._slash_context.conversation.submit(TextInput(line, Way.TYPED))
        return True

    def _run_slash(self, line: str) -> bool:
        """Print its answer; False if the person wants to leave."""
        try:
            show(run_command(line, self._slash_context))
        except Leave:
            return False
        except Exception:
            log.exception("command_failed", command=line.partition(" ")[0])
        return True

    def _interrupt(self) -> None:
        self._slash_context.conversation.submit(Interrupt("Ctrl-C", cause=Cause.TERMINAL))
        show("  [stopped; Ctrl-D exits]")

    def _leave(self) -> bool:
        app = self._session.app
        if app.loop is None or not app.is_running:
            return False
        app.loop.call_soon_threadsafe(lambda: app.exit(exception=EOFError()))
        return True

    def _toolbar(self) -> AnyFormattedText:
        app = get_app_or_none()
        width = app.output.get_size().columns if app else 80
        if stopped := stop_line(self._slash_context.software_stop.state):
            return [("class:stopped", stopped[: width - 1])]
        return self._view.status[: width - 1]


def _log_line(line: str) -> None:
    """A line that was written to stderr, with its colours."""
    sys.stdout.write(printable_in_colour(line) + "\n")  # noqa: TID251 - with its colours
    sys.stdout.flush()
