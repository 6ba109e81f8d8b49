"""Where the console's page is, as a browser asks for it."""

import socket

_EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104


def console_url(host: str, port: int, secure: bool) -> str:
    """The address of the page, by this machine's name where it listens on all of its addresses."""
    named = socket.gethostname() if host in _EVERYWHERE else host
    shown = f"[{named}]" if ":" in named else named
    return f"{'https' if secure else 'http'}://{shown}:{port}"
