"""The console that the settings want: its address and its encryption."""

from ipaddress import ip_address
from pathlib import Path

from edgevox.console.certificates import local_names, own_tls
from edgevox.console.console_server import ConsoleServer
from edgevox.console.context import ConsoleContext
from edgevox.console.tls import Tls
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import StateFiles
from edgevox.core.settings import Settings


def open_console(context: ConsoleContext, settings: Settings, folder: Path) -> ConsoleServer:
    """A console that listens; who made it starts and closes it. Raises `InvalidValue`, `OSError`.

    `folder` is the robot's own: who was let in, and its keys.
    """
    state = StateFiles()
    tls = tls_of(settings, folder, state)
    host, port, names = settings.console_host, settings.console_port, settings.console_names
    return ConsoleServer(context, folder, host, port, tls=tls, names=names, state=state)


def tls_of(settings: Settings, folder: Path, state: StateFiles | None = None) -> Tls | None:
    """Return the encryption; None for plain HTTP. Raises `InvalidValue`, and `OSError`."""
    if settings.console_tls == "own":
        return own_tls(folder, names_of(settings), state=state, spare=found_names(settings))
    if settings.console_tls == "files":
        if not settings.console_certificate or not settings.console_key:
            raise InvalidValue(
                "console_tls", "files", "console_certificate and console_key beside it"
            )
        return Tls(settings.console_certificate.expanduser(), settings.console_key.expanduser())
    if not settings.console_plain and not is_loopback(settings.console_host):
        raise InvalidValue(
            "console_tls",
            "off",
            "own or files where other machines can reach it, or console_plain where something "
            "else encrypts",
        )
    return None


def names_of(settings: Settings) -> tuple[str, ...]:
    """Return the console's names for its own certificate."""
    return local_names(_asked(settings))


def found_names(settings: Settings) -> frozenset[str]:
    """Return the names that this machine has by itself now, without the wanted ones."""
    return frozenset(local_names()) - set(_asked(settings))


def _asked(settings: Settings) -> list[str]:
    more = [one.strip().lower() for one in settings.console_names.split(",")]
    return [one for one in more if one]


def is_loopback(host: str) -> bool:
    """Return whether only this machine reaches this host."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
