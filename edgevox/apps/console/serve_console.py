"""Serves the console of an agent, if the settings ask for it."""

from contextlib import ExitStack
from typing import TYPE_CHECKING

from edgevox.apps.agent_parts import AgentParts
from edgevox.apps.console_command import shown_code
from edgevox.apps.folders import console_folder, recordings_folder
from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra
from edgevox.core.status import ComponentName, Off

if TYPE_CHECKING:
    from edgevox.console.console_server import ConsoleServer


def serve_console(stack: ExitStack, parts: AgentParts) -> None:
    """Answer browsers from now on, and print how one is let in; what must end is the stack's.

    Raises `EdgeVoxError` with the reason where it cannot; with `console_optional` one line says so.
    """
    try:
        with ExitStack() as own:
            server = _open(own, parts)
            stack.enter_context(own.pop_all())
    except EdgeVoxError as error:
        if not parts.settings.console_optional:
            raise
        parts.components.add(Off(ComponentName.CONSOLE, str(error)))
        _tell(parts, f"No console: {error}")
        return
    parts.components.add(server)


def _open(own: ExitStack, parts: AgentParts) -> "ConsoleServer":
    try:
        from edgevox.apps.console.build_context import build_context
        from edgevox.apps.console.robot_recorder import RobotRecorder, open_recorder
        from edgevox.apps.console.shared_sound import share_sound
        from edgevox.console.open_console import open_console
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"{error.name}: not here, expected {install_extra('console')}") from None
    folder = console_folder(parts.settings)
    try:
        sound = share_sound(own, parts)
        recorder = open_recorder(parts.settings, recordings_folder(parts.settings))
        if isinstance(recorder, RobotRecorder):
            own.callback(recorder.stop)
        server = open_console(build_context(parts, sound, recorder), parts.settings, folder)
        own.callback(server.close)
        code, address = server.offer_code()
    except OSError as error:
        raise EdgeVoxError(f"console_folder: {folder}: {error.strerror or error}") from None
    server.start()
    _tell(parts, f"Console: {server.url}")
    print(shown_code(server.url, code.code, code.shown, str(code.role)), flush=True)
    parts.notes.append(f"{address}  (once, for ten minutes; edgevox-console pair makes another)")
    return server


def _tell(parts: AgentParts, line: str) -> None:
    parts.notes.append(line)
    print(line, flush=True)
