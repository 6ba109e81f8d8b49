"""Errors of servers, by the reaction that each needs."""

from collections.abc import Callable

from edgevox.core.errors import EdgeVoxError


class ServerFailed(EdgeVoxError):
    """A server gave no usable answer; the message says why."""


class ServerBusy(ServerFailed):
    """The server works but has no room for this request; it may answer a later one."""


class Unreachable(ServerFailed):
    """The server cannot be reached or serve now; a second attempt may succeed."""


class Unusable(ServerFailed):
    """The server answers wrongly, and would answer the same request the same way."""


class RequestRefused(ServerFailed):
    """The server refused this request, perhaps as too long; it may serve others."""


class OddAnswer(ServerFailed):
    """The server works, and this answer makes no sense; others may."""


LOOK_S = 0.14
"""Seconds after which a server that has not answered is asked for a sign of life, and for which it
may take to give one."""


def is_alive(ask: Callable[[], object]) -> bool:
    """Whether a server answers this at all; what it answers does not matter."""
    try:
        ask()
    except Unreachable:
        return False
    except ServerFailed:
        pass
    return True


_OF_THE_REQUEST = (400, 413, 422)
_FOR_NOW = (408, 425)
_FULL, _AWAY = 429, 503


def by_status(status: int, route: str, said: str, *, later: bool = False) -> ServerFailed:
    """The error that an HTTP status other than 200 stands for.

    `later` is whether the server says when to come again, by which a 503 means that it is full and
    not that it is gone. A full one is not tried again: who waits in its queue would wait twice.
    """
    message = f"{route} answered {status}: {said}"
    if status == _FULL or (status == _AWAY and later):
        return ServerBusy(message)
    if status in _OF_THE_REQUEST:
        return RequestRefused(message)
    return Unreachable(message) if status in _FOR_NOW or status >= 500 else Unusable(message)
