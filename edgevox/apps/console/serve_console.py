"""Serves the console of an agent, if the settings ask for it."""

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.console_command import shown_code
from edgevox.apps.folders import console_folder, recordings_folder
from edgevox.apps.streams import show
from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.core.log import get_logger
from edgevox.core.status import ComponentName, Level, Off

if TYPE_CHECKING:
    from edgevox.console.console_server import ConsoleServer

log = get_logger(__name__)


class _FolderUnusable(EdgeVoxError):
    """The console's files can be neither read nor made."""


def serve_console(stack: ExitStack, parts: AgentParts) -> None:
    """Answer browsers from now on, and print how one is let in; what must end is the stack's.

    A disk that is full or read-only costs the robot its console at most. Raises `EdgeVoxError` for
    whatever else is wrong; with `console_optional` one line says so.
    """
    try:
        with ExitStack() as own:
            server = _open(own, parts)
            stack.enter_context(own.pop_all())
    except _FolderUnusable as error:
        log.error("console_off", reason=str(error))  # noqa: TRY400 - the reason says it all
        parts.components.add(Off(ComponentName.CONSOLE, str(error), level=Level.ERROR))
        _tell(parts, f"No console: {error}")
        return
    except EdgeVoxError as error:
        if not parts.settings.console_optional:
            raise
        parts.components.add(Off(ComponentName.CONSOLE, str(error)))
        _tell(parts, f"No console: {error}")
        return
    parts.components.add(server)


def _open(own: ExitStack, parts: AgentParts) -> "ConsoleServer":
    try:
        from edgevox.apps.console.build_context import build_context, share_sound
        from edgevox.apps.console.robot_recorder import RobotRecorder, open_recorder
        from edgevox.console.console_server import open_console
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"{error.name}: not here, expected {install_extra('console')}") from None
    folder = console_folder(parts.settings)
    try:
        sound = share_sound(own, parts)
        recorder = open_recorder(parts.settings, recordings_folder(parts.settings))
        if isinstance(recorder, RobotRecorder):
            own.callback(recorder.close)
            recorder.mend()
            parts.components.add(recorder)
        else:
            parts.components.add(Off(ComponentName.RECORDINGS, f"not here: {recorder}"))
        server = open_console(build_context(parts, sound, recorder), parts.settings, folder)
        own.callback(server.close)
    except OSError as error:
        raise _FolderUnusable(f"console_folder: {folder}: {error.strerror or error}") from None
    if parts.metrics is not None:
        parts.metrics.read("edgevox_console_bad_requests_total", lambda: server.bad.counts)
    server.start()
    _tell(parts, f"Console: {server.url}")
    _offer(parts, server, folder)
    return server


def _offer(parts: AgentParts, server: "ConsoleServer", folder: Path) -> None:
    """Show a pairing code. Where none can be written only browsers that are paired get in."""
    try:
        code, address = server.offer_code()
    except OSError as error:
        reason = f"console_folder: {folder}: {error.strerror or error}"
        log.error("console_codeless", reason=reason)  # noqa: TRY400 - the reason says it all
        _tell(parts, f"No pairing code: {reason}")
        return
    show(shown_code(server.url, code.code, code.shown, str(code.role)))
    parts.notes.append(f"{address}  (once, for ten minutes; /pair makes one for a phone)")


def _tell(parts: AgentParts, line: str) -> None:
    parts.notes.append(line)
    show(line)
