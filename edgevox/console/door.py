"""The door: limits the number of connections, before any handshake or request.

A client with many connections, or with connections that show no session, makes room for the others:
a new browser always gets in, and no crowd of strangers shuts out a paired browser.
"""

import asyncio
import socket
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

from edgevox.console.certificates import CurrentTls
from edgevox.console.limits import BadRequest, BadRequests
from edgevox.core.log import get_logger

log = get_logger(__name__)

MOST = 64
"""Connections in all."""
MOST_OF_SESSION = 16
"""Connections of one session; of more, its oldest is ended. A page holds three."""
FEW = 3
"""Clients with at most this many connections never make room for others: a page needs them."""
MOST_UNKNOWN = 24
"""Connections of one address, of those that have shown no session: some browsers' at once."""
UNKNOWN_S = 30.0
"""A connection that has shown no session by then is ended."""
HANDSHAKE_S = 5.0
FULL_S = 0.5
"""Seconds after which connections are let in again, once the process had no more files to open."""
SEND_BYTES = 64 * 1024
"""Bytes that the system buffers of what is sent: more would only be late."""


def cut(transport: asyncio.BaseTransport | None) -> None:
    """End a connection at once, if there is one.

    A TLS transport of Python 3.11.2 (Debian 12) that was closed twice cannot be aborted any more,
    and raises `AttributeError`.
    """
    if isinstance(transport, asyncio.WriteTransport):
        with suppress(AttributeError):
            transport.abort()


@dataclass(eq=False)
class _Guest:
    address: str
    session: str = ""
    """The connection's session; empty until a request has shown it."""
    transport: asyncio.BaseTransport | None = None
    task: "asyncio.Task[None] | None" = field(default=None, repr=False)

    def leave(self) -> None:
        if self.task and not self.task.done():
            self.task.cancel()
        cut(self.transport)

    def leave_if_unknown(self) -> None:
        if not self.session:
            self.leave()

    @property
    def is_there(self) -> bool:
        if self.transport is None:
            return self.task is not None and not self.task.done()
        return not self.transport.is_closing()


class Door:
    """Lets connections of one listening socket in, on its loop, until it is cancelled."""

    def __init__(
        self,
        listening: socket.socket,
        protocol: Callable[[], asyncio.Protocol],
        *,
        tls: CurrentTls | None,
        bad: BadRequests | None = None,
    ) -> None:
        self._bad = bad or BadRequests()
        self._listening = listening
        self._protocol = protocol
        self._tls = tls
        self._guests: dict[asyncio.BaseProtocol | None, _Guest] = {}
        self.shut = ""
        """The reason why the last connection could not be let in; empty while they can."""

    def __len__(self) -> int:
        self._forget()
        return len(self._guests)

    def knows(self, protocol: asyncio.BaseProtocol | None, session: str) -> None:
        """A request on this connection has shown this session, which may hold so many."""
        guest = self._guests.get(protocol)
        if not guest:
            return
        guest.session = session
        self._forget()
        own = [one for one, other in self._guests.items() if other.session == session]
        for one in own[:-MOST_OF_SESSION]:
            self._end(one)

    async def serve(self, listening: socket.socket | None = None) -> None:
        """Let connections in, by its own socket or by a further one; the limits are the same."""
        loop, listening = asyncio.get_running_loop(), listening or self._listening
        while True:
            try:
                connection, peer = await loop.sock_accept(listening)
            except OSError as error:
                self.shut = str(error)
                log.warning("console_door_full", error=self.shut)
                await asyncio.sleep(FULL_S)
                continue
            self.shut = ""
            self._admit(loop, connection, str(peer[0]))

    def close(self) -> None:
        """End all that are there."""
        for guest in self._guests.values():
            guest.leave()
        self._guests.clear()

    def _admit(
        self, loop: asyncio.AbstractEventLoop, connection: socket.socket, address: str
    ) -> None:
        if not self._make_room(address):
            connection.close()
            return
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BYTES)
        with suppress(OSError):
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        protocol, guest = self._protocol(), _Guest(address)
        guest.task = loop.create_task(self._connect(loop, connection, protocol, guest))
        self._guests[protocol] = guest
        loop.call_later(UNKNOWN_S, guest.leave_if_unknown)

    async def _connect(
        self,
        loop: asyncio.AbstractEventLoop,
        connection: socket.socket,
        protocol: asyncio.Protocol,
        guest: _Guest,
    ) -> None:
        try:
            guest.transport, _ = await loop.connect_accepted_socket(
                lambda: protocol,
                connection,
                ssl=self._tls.context if self._tls else None,
                ssl_handshake_timeout=HANDSHAKE_S if self._tls else None,
            )
        except OSError:  # of TLS, too: who does not speak it is not let in
            self._bad.count(BadRequest.TLS if self._tls else BadRequest.CONNECTION)
            connection.close()
        except asyncio.CancelledError:
            connection.close()
            raise

    def _make_room(self, address: str) -> bool:
        """Return whether one more connection of this address fits; it may end an older one.

        The older one has no session yet, or is one of the session that holds the most.
        """
        self._forget()
        unknown = [one for one, guest in self._guests.items() if not guest.session]
        same = [one for one in unknown if self._guests[one].address == address]
        crowded = len(same) >= MOST_UNKNOWN
        if not crowded and len(self._guests) < MOST:
            return True
        if unknown:
            self._end(same[0] if crowded else unknown[0])
            return True
        held = Counter(guest.session for guest in self._guests.values())
        most, count = held.most_common(1)[0]
        if count <= FEW:
            return False
        self._end(next(one for one, guest in self._guests.items() if guest.session == most))
        return True

    def _end(self, one: asyncio.BaseProtocol | None) -> None:
        self._bad.count(BadRequest.CROWD)
        self._guests.pop(one).leave()

    def _forget(self) -> None:
        self._guests = {one: guest for one, guest in self._guests.items() if guest.is_there}
