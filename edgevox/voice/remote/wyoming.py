"""Wyoming, the protocol of Home Assistant's voice services: a line of JSON, then sound, over TCP.

It has no keys and no encryption. The package `wyoming` has the format; the bounds are here.
"""

import socket
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import BufferedIOBase
from typing import IO, Any
from urllib.parse import urlsplit

from wyoming.error import Error
from wyoming.event import Event, read_event, write_event
from wyoming.info import Describe, Info

from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import LOOK_S, OddAnswer, Unreachable, Unusable, is_alive
from edgevox.core.servers.exchange import CONNECT_S, SILENCE_S, Exchange, Exchanges

MOST_BYTES = 16 << 20
"""A longer answer than this is not one: five minutes of speech at 24 kHz."""
LONGEST_LINE = 1 << 16
LONGEST_PART = 1 << 20
"""Bytes of an event's data, and of its sound."""
_NOT_WYOMING = (AssertionError, AttributeError, TypeError, KeyError, ValueError, RecursionError)
"""What the package raises for events that are none."""
SCHEMES = ("tcp", "wyoming")


class BoundedReader:
    """What `read_event` reads from: a stream whose lines, parts and whole are bounded."""

    def __init__(self, stream: IO[bytes] | BufferedIOBase, most_bytes: int = MOST_BYTES) -> None:
        self._stream = stream
        self._left = most_bytes
        self.ended = False
        """True once the stream was over, between two events or within one."""

    def readline(self) -> bytes:
        line = self._stream.readline(LONGEST_LINE + 1)
        if len(line) > LONGEST_LINE:
            raise Unusable("not Wyoming: a line without end")
        return self._taken(line)

    def read(self, size: int) -> bytes:
        if size > LONGEST_PART:
            raise Unusable(f"an event of {size} bytes, expected at most {LONGEST_PART >> 20} MiB")
        return self._taken(self._stream.read(size))

    def _taken(self, data: bytes) -> bytes:
        self._left -= len(data)
        self.ended = self.ended or not data
        if self._left < 0:
            raise Unusable(f"a reply of more than {MOST_BYTES >> 20} MiB")
        return data


class WyomingRequest(Exchange[Event]):
    """Events to a server, and those that it sends back."""

    def __init__(self, host: str, port: int, sends: Sequence[Event], deadline_s: float) -> None:
        super().__init__(deadline_s)
        self._where = (host, port)
        self._sends = sends

    def _receive(self) -> None:
        with socket.create_connection(self._where, CONNECT_S) as connected:
            self._keep(connected)
            connected.settimeout(SILENCE_S)
            with connected.makefile("wb") as writer, connected.makefile("rb") as stream:
                for event in self._sends:
                    write_event(event, writer)
                reader = BoundedReader(stream)
                while not self.dropped and (event := next_event(reader)):
                    self._put(event)


def next_event(reader: BoundedReader) -> Event | None:
    """The next event; None at the end. Raises `Unusable` for what is none, `OSError`."""
    try:
        event = read_event(reader)
    except _NOT_WYOMING:
        raise Unusable("not Wyoming: no event") from None
    if event is None and not reader.ended:
        raise Unusable("not Wyoming: no event")
    if event is not None and not (isinstance(event.type, str) and isinstance(event.data, dict)):
        raise Unusable("not Wyoming: no event")
    return event


class WyomingServer:
    """A server that is asked by Wyoming, by several threads at once, on a connection for each."""

    def __init__(self, address: Address) -> None:
        self.address = address
        parts = urlsplit(address.url)
        self._host, self._port = parts.hostname or "", parts.port or 0
        self._exchanges = Exchanges(address.host)

    @contextmanager
    def ask(
        self, sends: Iterable[Event], deadline_s: float, token: CancelToken
    ) -> Iterator[WyomingRequest]:
        """Send these events; the request gives what comes back. Raises `ServerFailed`."""
        one = WyomingRequest(self._host, self._port, [*sends], deadline_s)
        self._exchanges.begin(one)
        forget = token.on_cancel(one.drop)
        try:
            yield one
        finally:
            forget()
            one.drop()

    def describe(self, deadline_s: float, token: CancelToken) -> Info | None:
        """What the server has; None if cancelled. Raises `ServerFailed`."""
        with self.ask([Describe().event()], deadline_s, token) as request:
            for event in answers(request):
                if Info.is_type(event.type):
                    return read_as(Info, event)
        if token.cancelled:
            return None
        raise Unreachable("the connection ended before the server described itself")

    def lives(self, token: CancelToken) -> bool:
        """Whether it answers within `LOOK_S`."""
        return is_alive(lambda: self.describe(time.monotonic() + LOOK_S, token))

    def close(self) -> None:
        """End all requests and their threads."""
        self._exchanges.close()


def answers(request: WyomingRequest) -> Iterator[Event]:
    """The events as they come. Raises `OddAnswer` for an error that the server tells."""
    for event in request.items():
        if Error.is_type(event.type):
            said = " ".join(str(event.data.get("text", "")).split())[:200]
            raise OddAnswer(f"the server says: {said or 'error'}")
        yield event


def read_as(kind: Any, event: Event) -> Any:
    """The event as one of the package's types. Raises `OddAnswer` for one that lacks its fields."""
    try:
        return kind.from_event(event)
    except _NOT_WYOMING:
        raise OddAnswer(f"an event {event.type!r} without its fields") from None


def deadline(address: Address) -> float:
    """When an answer that is asked for now must begin, in `time.monotonic`."""
    return time.monotonic() + address.timeout_s
