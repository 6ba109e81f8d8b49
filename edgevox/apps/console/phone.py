"""Lets a phone in: the address by which it reaches the console, opened if a person agrees."""

import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from edgevox.console.opened import Opened, network_address
from edgevox.console.sessions import Code, Pairing, Role
from edgevox.console.tls import console_url
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings

CONNECT_S = 2.0
OPENS_S = 5.0
"""Seconds until a running console has opened."""


class NotOpen(EdgeVoxError):
    """The console answers on this machine only, and nobody agreed to open it."""


@dataclass(frozen=True, slots=True)
class PhonePairing:
    """A pairing code, and the address that a phone opens."""

    url: str
    code: Code


def pair_phone(
    settings: Settings, folder: Path, role: Role, agree: Callable[[str], bool]
) -> PhonePairing:
    """Make a code for a phone of this network.

    If the console answers on this machine only, `agree` is asked whether it may open at an address.
    Raises `EdgeVoxError`, and `OSError` where the folder cannot be written.
    """
    host, port = _address(settings), settings.console_port
    url = console_url(host, port, settings.console_tls != "off")
    if not _answers(host, port):
        if not _answers("127.0.0.1", port):
            raise EdgeVoxError(
                f"console: nothing answers on port {port} of this machine, expected a robot that"
                " runs with its console, such as make run"
            )
        if not agree(url):
            raise NotOpen(
                f"console: it answers on this machine only, expected an agreement to open {url}"
            )
        _open(settings, folder, host)
    return PhonePairing(url, Pairing(folder).offer(role))


def _address(settings: Settings) -> str:
    first = settings.console_names.partition(",")[0].strip()
    host = first or network_address()
    if not host or host in ("localhost", "127.0.0.1", "::1"):
        raise InvalidValue(
            "console_names",
            first,
            "the name or address by which a phone reaches this machine (in a container:"
            " CONSOLE_ADDRESS=0.0.0.0 and EDGEVOX_CONSOLE_NAMES=ADDRESS, for docker compose)",
        )
    return host


def _open(settings: Settings, folder: Path, host: str) -> None:
    opened = Opened(folder)
    address = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0][4][0]
    opened.open(str(address))
    until = time.monotonic() + OPENS_S
    while not _answers(host, settings.console_port):
        if time.monotonic() > until:
            opened.close()
            raise EdgeVoxError(
                "console: this robot's settings keep it to this machine, expected a restart with"
                f" --console-host 0.0.0.0 --console-names {host}"
            )
        time.sleep(0.2)


def _answers(host: str, port: int) -> bool:
    try:
        socket.create_connection((host, port), CONNECT_S).close()
    except OSError:
        return False
    return True
