"""Ports for servers that cannot be made with 0."""

import random
import socket

BELOW = range(20_000, 32_000)
"""Below those that the system gives to whoever asks for any, so that nobody gets it meanwhile."""


def free_port() -> int:
    """A port of loopback that nobody has now."""
    while True:
        port = random.SystemRandom().choice(BELOW)
        try:
            socket.create_server(("127.0.0.1", port)).close()
        except OSError:
            continue
        return port
