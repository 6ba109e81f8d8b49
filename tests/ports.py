"""Ports for servers that cannot be made with 0."""

import errno
import random
import socket

BELOW = range(20_000, 32_000)
"""Below those that Linux gives to whoever asks for any, so that nobody gets it meanwhile."""


def free_port() -> int:
    """A port of loopback that nobody has now."""
    while True:
        port = random.SystemRandom().choice(BELOW)
        try:
            socket.create_server(("127.0.0.1", port)).close()
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
        else:
            return port
