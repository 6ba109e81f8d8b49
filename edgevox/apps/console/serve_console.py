"""Serves the console of an agent, if the settings ask for it."""

from contextlib import ExitStack

from edgevox.apps.agent_parts import AgentParts
from edgevox.apps.console_command import shown_code
from edgevox.apps.folders import console_folder
from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra


def serve_console(stack: ExitStack, parts: AgentParts) -> None:
    """Answer browsers from now on, and print how one is let in; what must end is the stack's.

    Raises `EdgeVoxError` with the reason where it cannot.
    """
    try:
        from edgevox.apps.console.build_context import build_context
        from edgevox.apps.console.shared_sound import share_sound
        from edgevox.console.open_console import open_console
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"{error.name}: not here, expected {install_extra('console')}") from None
    folder = console_folder(parts.settings)
    try:
        sound = share_sound(stack, parts)
        server = open_console(build_context(parts, sound), parts.settings, folder)
        stack.callback(server.close)
        code, _ = server.offer_code()
    except OSError as error:
        raise EdgeVoxError(f"console_folder: {folder}: {error.strerror or error}") from None
    server.start()
    parts.components.add(server)
    print(f"Console: {server.url}", flush=True)
    print(shown_code(server.url, code.code, code.shown, str(code.role)), flush=True)
