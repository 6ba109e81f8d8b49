"""A small HTTP server: a few pages that are made when they are asked for, by GET or HEAD.

Our own, since these pages say whether a robot lives: who holds connections or sends slowly must not
keep the next one from its answer. `http.server` gives each connection a thread or makes all wait
for one, and a web framework would be much for a handful of pages.
"""

import asyncio
import ipaddress
import json
import socket
import threading
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from http import HTTPStatus

from edgevox.core.errors import InvalidValue

REQUEST_S = 2.0
"""How long a request may take to arrive and its answer to leave."""
MOST_BYTES = 4096
MOST_AT_ONCE = 64
"""Of more, the address that holds most is hung up on: its oldest connection."""
MOST_TAKEN = 16
"""So many connections are taken up before those that are there are looked at again."""
MOST_KNOCKING = 128
"""So many may wait to be taken up."""


@dataclass(frozen=True, slots=True)
class Page:
    """What is answered."""

    body: bytes
    content_type: str
    status: HTTPStatus = HTTPStatus.OK


def json_page(content: Mapping[str, object], status: HTTPStatus = HTTPStatus.OK) -> Page:
    """A page for people and programs."""
    return Page(json.dumps(content).encode() + b"\n", "application/json", status)


class HttpServer:
    """Listens from its making on and answers from `start` to `close`, on a thread of its own.

    `pages` gives by path what makes a page, on that thread: quickly. Who is slow to ask or to hear
    is hung up on, at once where others come: whoever asks is answered, however many connections
    somebody holds. `slow_pages` are made on a thread of their own: one that hangs keeps none of the
    others from being answered. `orders` are for PUT, from this machine only: a page in a browser
    may not send PUT elsewhere unasked. Raises `InvalidValue`, naming the setting that gave the
    port, where it cannot listen.
    """

    def __init__(
        self,
        pages: Mapping[str, Callable[[], Page]],
        host: str,
        port: int,
        *,
        setting: str,
        name: str,
        orders: Mapping[str, Callable[[], Page]] | None = None,
        slow_pages: Mapping[str, Callable[[], Page]] | None = None,
    ) -> None:
        self._pages = dict(pages)
        self._slow_pages = dict(slow_pages or {})
        self._slow = ThreadPoolExecutor(1, thread_name_prefix=f"{name}-slow")
        self._orders = dict(orders or {})
        self._socket = _listen(host, port, setting)
        self._loop = asyncio.new_event_loop()
        self._closed = asyncio.Event()
        self._clients: dict[asyncio.StreamWriter, str] = {}
        self._thread = threading.Thread(target=self._serve, name=name)

    @property
    def port(self) -> int:
        """Where it listens: the machine's choice if it was made with 0."""
        return int(self._socket.getsockname()[1])

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Answer no more."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._closed.set)
            self._thread.join()
        self._slow.shutdown(wait=False, cancel_futures=True)
        self._loop.close()
        self._socket.close()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._answer_until_closed())
        left = asyncio.all_tasks(self._loop)
        for task in left:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*left, return_exceptions=True))

    async def _answer_until_closed(self) -> None:
        server = await asyncio.start_server(
            self._client, sock=self._socket, limit=MOST_BYTES, backlog=MOST_TAKEN
        )
        self._socket.listen(MOST_KNOCKING)
        await self._closed.wait()
        server.close()

    async def _client(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._make_room()
        self._clients[writer] = str((writer.get_extra_info("peername") or ("",))[0])
        writer.transport.set_write_buffer_limits(high=0)  # what is drained has left
        try:
            async with asyncio.timeout(REQUEST_S):
                await self._answer(reader, writer)
        except (TimeoutError, OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            writer.transport.abort()  # who asks or listens like this hears nothing
        finally:
            self._clients.pop(writer, None)
            with suppress(OSError):
                writer.close()

    def _make_room(self) -> None:
        if len(self._clients) < MOST_AT_ONCE:
            return
        held = Counter(self._clients.values())
        oldest = max(self._clients, key=lambda one: held[self._clients[one]])  # of equals the first
        del self._clients[oldest]
        oldest.transport.abort()

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        head = await reader.readuntil(b"\r\n\r\n")
        method, _, rest = head.split(b"\r\n", 1)[0].decode("latin-1").partition(" ")
        peer = str((writer.get_extra_info("peername") or ("",))[0])
        path = rest.partition(" ")[0].partition("?")[0]
        if path in self._slow_pages and method in ("GET", "HEAD"):
            page = await self._loop.run_in_executor(self._slow, self._slow_pages[path])
        else:
            page = self._page(method, path, peer)
        allow = "Allow: GET, HEAD\r\n" if page.status is HTTPStatus.METHOD_NOT_ALLOWED else ""
        writer.write(
            f"HTTP/1.1 {page.status.value} {page.status.phrase}\r\n"
            f"Content-Type: {page.content_type}\r\nContent-Length: {len(page.body)}\r\n"
            f"Cache-Control: no-store\r\n{allow}Connection: close\r\n\r\n".encode()
        )
        writer.write(b"" if method == "HEAD" else page.body)
        await writer.drain()

    def _page(self, method: str, path: str, peer: str) -> Page:
        if method == "PUT" and path in self._orders:
            return self._orders[path]() if is_here(peer) else _FROM_HERE_ONLY
        if method not in ("GET", "HEAD"):
            return json_page({"error": "only GET and HEAD"}, HTTPStatus.METHOD_NOT_ALLOWED)
        if path not in self._pages:
            known = " and ".join([*self._pages, *self._slow_pages])
            return json_page({"error": f"only {known}"}, HTTPStatus.NOT_FOUND)
        return self._pages[path]()


_FROM_HERE_ONLY = json_page({"error": "only from this machine"}, HTTPStatus.FORBIDDEN)


def is_here(peer: str) -> bool:
    """Whether an address is this machine's loopback, also as IPv6 writes one of IPv4."""
    try:
        address = ipaddress.ip_address(peer.partition("%")[0])
    except ValueError:
        return False
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return (mapped or address).is_loopback


def _listen(host: str, port: int, setting: str) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidValue(
            setting, f"{host}:{port}", f"an address and a free port of this machine ({reason})"
        ) from None
