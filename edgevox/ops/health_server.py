"""Serves health over HTTP, as container engines and clusters ask for it: GET /live, GET /ready."""

import asyncio
import json
import logging
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus

from edgevox.core.errors import InvalidValue
from edgevox.ops.health import Health, Report

log = logging.getLogger(__name__)

REQUEST_S = 2.0
"""How long a request may take to arrive and its answer to leave."""
MOST_BYTES = 4096
MOST_AT_ONCE = 16


class HealthServer:
    """Listens from its making on and answers from `start` to `close`, on a thread of its own.

    Raises `InvalidValue` where it cannot listen.
    """

    def __init__(self, health: Health, host: str, port: int) -> None:
        self._reports: dict[str, Callable[[], Report]] = {
            "/live": health.live,
            "/ready": health.ready,
        }
        self._socket = _listen(host, port)
        self._loop = asyncio.new_event_loop()
        self._clients = 0
        self._thread = threading.Thread(target=self._serve, name="edgevox-health")

    @property
    def port(self) -> int:
        """Where it listens: the machine's choice if it was made with 0."""
        return int(self._socket.getsockname()[1])

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Answer no more."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
        self._loop.close()
        self._socket.close()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        server = self._loop.run_until_complete(
            asyncio.start_server(self._client, sock=self._socket, limit=MOST_BYTES)
        )
        self._loop.run_forever()
        server.close()
        left = asyncio.all_tasks(self._loop)
        for task in left:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*left, return_exceptions=True))

    async def _client(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._clients += 1
        try:
            if self._clients <= MOST_AT_ONCE:
                async with asyncio.timeout(REQUEST_S):
                    await self._answer(reader, writer)
        except (TimeoutError, OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            pass  # who asks like this hears nothing
        finally:
            self._clients -= 1
            with suppress(OSError):
                writer.close()

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        head = await reader.readuntil(b"\r\n\r\n")
        method, _, rest = head.split(b"\r\n", 1)[0].decode("latin-1").partition(" ")
        status, body = self._reply(method, rest.partition(" ")[0].partition("?")[0])
        data = json.dumps(body).encode() + b"\n"
        allow = "Allow: GET, HEAD\r\n" if status is HTTPStatus.METHOD_NOT_ALLOWED else ""
        writer.write(
            f"HTTP/1.1 {status.value} {status.phrase}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(data)}\r\n"
            f"Cache-Control: no-store\r\n{allow}Connection: close\r\n\r\n".encode()
        )
        writer.write(b"" if method == "HEAD" else data)
        await writer.drain()

    def _reply(self, method: str, path: str) -> tuple[HTTPStatus, dict[str, object]]:
        if method not in ("GET", "HEAD"):
            return HTTPStatus.METHOD_NOT_ALLOWED, {"error": "only GET and HEAD"}
        if path not in self._reports:
            return HTTPStatus.NOT_FOUND, {"error": "only " + " and ".join(self._reports)}
        report = self._reports[path]()
        return HTTPStatus.OK if report.well else HTTPStatus.SERVICE_UNAVAILABLE, report.as_json()


def _listen(host: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidValue(
            "health_port",
            f"{host}:{port}",
            f"an address and a free port of this machine ({reason})",
        ) from None
