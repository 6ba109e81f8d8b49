"""The URL of the console's page, as a browser asks for it."""

import socket

_EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104


def console_url(host: str, port: int, secure: bool, names: str = "") -> str:
    """The address of the page.

    Where it listens on all addresses of the machine, that is by the first of its `names`, with
    commas between, or else by the machine's.
    """
    first = names.partition(",")[0].strip()
    named = (first or socket.gethostname()) if host in _EVERYWHERE else host
    shown = f"[{named}]" if ":" in named else named
    return f"{'https' if secure else 'http'}://{shown}:{port}"
