"""Lets a phone in: the address by which it reaches the console, opened if a person agrees."""

import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path

from edgevox.console.certificates import console_url
from edgevox.console.console_server import is_loopback
from edgevox.console.sessions import Code, Opened, Pairing, Role, network_address
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings

CONNECT_S = 2.0
OPENS_S = 5.0
"""Seconds until a running console has opened."""
LOOK_S = 0.2


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
    host, port = _host(settings), settings.console_port
    url = console_url(host, port, settings.console_tls != "off")
    address = host if _is_address(host) else network_address()
    if is_loopback(settings.console_host) and not _answers(address, port):
        if not _answers("127.0.0.1", port):
            raise EdgeVoxError(
                f"console: nothing answers on port {port} of this machine, expected a robot that"
                " runs with its console, such as make run"
            )
        if not agree(url):
            raise NotOpen(
                f"console: it answers on this machine only, expected an agreement to open {url}"
            )
        _open(Opened(folder), address, port)
    return PhonePairing(url, Pairing(folder).offer(role))


def _host(settings: Settings) -> str:
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


def _is_address(host: str) -> bool:
    try:
        return bool(ip_address(host))
    except ValueError:
        return False


def _open(opened: Opened, address: str, port: int) -> None:
    opened.open(address)
    until = time.monotonic() + OPENS_S
    while not _answers(address, port):
        if time.monotonic() > until:
            opened.close()
            raise EdgeVoxError(
                "console: this robot's settings keep it to this machine, expected a restart with"
                f" --console-host 0.0.0.0 --console-names {address}"
            )
        time.sleep(LOOK_S)


def _answers(host: str, port: int) -> bool:
    try:
        socket.create_connection((host, port), CONNECT_S).close()
    except OSError:
        return False
    return True
