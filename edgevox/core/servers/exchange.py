"""An exchange with a server on a thread of its own, so that a caller can always stop waiting."""

import contextlib
import socket
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from queue import Empty, SimpleQueue
from typing import Generic, TypeVar

from edgevox.core.servers.errors import ServerFailed, Unreachable

CONNECT_S = 3.0
SILENCE_S = 120.0
"""Seconds of silence that end a connection which was not dropped; its reader has a deadline too."""

Item = TypeVar("Item")


class Exchange(ABC, Generic[Item]):
    """A request that is sent when it is begun. Read with `take`; always `drop` it.

    `deadline_s`, in `time.monotonic`, ends the wait for more; the reader may move it. No server can
    hold up the reader: not by names that do not resolve, a connection that hangs, or an answer that
    trickles in. `drop` closes the connection, which tells the server to stop.

    A subclass receives in `_receive`, on the exchange's thread: it calls `_keep` with its socket
    and `_put` with each item.
    """

    def __init__(self, deadline_s: float) -> None:
        self.deadline_s = deadline_s
        self._lock = threading.Lock()
        self._dropped = False
        self._socket: socket.socket | None = None
        self._heard: SimpleQueue[Item | ServerFailed | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="edgevox-endpoint")

    def begin(self) -> None:
        self._thread.start()

    def take(self) -> Item | None:
        """The next item; None at the end, and once it was dropped. Raises `ServerFailed`."""
        left_s = self.deadline_s - time.monotonic()
        try:
            item = self._heard.get(timeout=left_s) if left_s > 0 else _too_late()
        except Empty:
            item = _too_late()
        if self._dropped:
            return None
        if isinstance(item, ServerFailed):
            raise item
        return item

    def items(self) -> Iterator[Item]:
        """The items as they come. Raises `ServerFailed`."""
        while (item := self.take()) is not None:
            yield item

    def drop(self) -> None:
        """Close the connection; `take` ends. Any thread may call it."""
        with self._lock:
            self._dropped = True
            self._hang_up()
        self._heard.put(None)

    def join(self) -> None:
        """Wait for the thread of an exchange that was dropped."""
        self._thread.join()

    @property
    def dropped(self) -> bool:
        """True once it was dropped."""
        return self._dropped

    @property
    def running(self) -> bool:
        """True while the thread is alive."""
        return self._thread.is_alive()

    @abstractmethod
    def _receive(self) -> None:
        """Send the request and put what comes. Raises `ServerFailed` and `OSError`."""

    def _put(self, item: Item | ServerFailed) -> None:
        self._heard.put(item)

    def _keep(self, connected: socket.socket) -> None:
        """Keep the socket: to shut it down is all that wakes a thread that reads from it."""
        with self._lock:
            self._socket = connected
            if self._dropped:
                self._hang_up()

    def _run(self) -> None:
        try:
            self._receive()
        except ServerFailed as error:
            self._heard.put(error)
        except OSError as error:
            self._heard.put(Unreachable(str(error) or type(error).__name__))
        finally:
            self._heard.put(None)

    def _hang_up(self) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):  # it may be closed already
                socket.socket.shutdown(self._socket, socket.SHUT_RDWR)


def _too_late() -> ServerFailed:
    return Unreachable("no answer in time")


class Exchanges:
    """The exchanges of one client, which all end when it is closed. For any thread."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._closed = threading.Event()
        self._lock = threading.Lock()
        self._open: set[Exchange[object]] = set()

    @property
    def closed(self) -> bool:
        """True once the client was closed."""
        return self._closed.is_set()

    def begin(self, exchange: Exchange[Item]) -> None:
        """Begin it. Raises `Unreachable` once the client is closed."""
        with self._lock:
            self.refuse_if_closed()
            self._open = {one for one in self._open if one.running}
            exchange.begin()
            self._open.add(exchange)  # type: ignore[arg-type]

    def refuse_if_closed(self) -> None:
        """Raise `Unreachable` once the client is closed."""
        if self.closed:
            raise Unreachable(f"{self._name} is closed")

    def close(self) -> None:
        """Drop all, and wait for their threads."""
        self._closed.set()
        with self._lock:
            left = list(self._open)
        for one in left:
            one.drop()
        for one in left:
            one.join()
