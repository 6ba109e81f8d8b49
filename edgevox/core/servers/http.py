"""Requests over HTTP to a server of models."""

import ssl
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from typing import Any

import httpx

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import read_json
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import LOOK_S, Unreachable, Unusable, by_status, is_alive
from edgevox.core.servers.exchange import CONNECT_S, SILENCE_S, Exchange, Exchanges

MOST_BYTES = 4 << 20
"""A longer reply than this is not an answer; 160 tokens take some 60 kB."""
_CONNECTED = ("connection.connect_tcp.complete", "connection.start_tls.complete")


class HttpRequest(Exchange[int | bytes]):
    """One request: its status, then its reply. `sends` are httpx's arguments; none is a GET."""

    def __init__(
        self,
        client: httpx.Client,
        url: str,
        headers: Mapping[str, str],
        sends: Mapping[str, Any],
        *,
        deadline_s: float,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        super().__init__(deadline_s)
        self.later = False
        """True if the server said when to try again; known once `status` is."""
        self.kind = ""
        """The media type of the reply, in lower case; known once `status` is."""
        self._client = client
        self._most_bytes = most_bytes
        self._request = client.build_request(
            "POST" if sends else "GET",
            url,
            headers=dict(headers),
            timeout=httpx.Timeout(SILENCE_S, connect=CONNECT_S),
            extensions={"trace": self._trace},
            **sends,
        )

    def status(self) -> int:
        """The HTTP status; 0 if it was dropped. Raises `ServerFailed`."""
        first = self.take()
        if isinstance(first, int):
            return first
        if not self.dropped:
            raise Unreachable("the connection ended without a word")
        return 0

    def chunks(self) -> Iterator[bytes]:
        """The reply as it comes, to its end or until it is dropped. Raises `ServerFailed`."""
        while isinstance(chunk := self.take(), bytes):
            yield chunk

    def reply(self) -> bytes:
        """The whole reply."""
        return b"".join(self.chunks())

    def _receive(self) -> None:
        try:
            self._read()
        except httpx.HTTPError as error:
            raise Unreachable(str(error) or type(error).__name__) from None

    def _read(self) -> None:
        response = self._client.send(self._request, stream=True)
        size = 0
        try:
            self.later = "retry-after" in response.headers
            self.kind = response.headers.get("content-type", "").partition(";")[0].strip().lower()
            self._put(response.status_code)
            for chunk in response.iter_raw():
                size += len(chunk)
                if self.dropped:
                    return
                if size > self._most_bytes:
                    raise Unusable(f"a reply of more than {self._most_bytes >> 20} MiB")
                self._put(chunk)
        finally:
            response.close()

    def _trace(self, event: str, info: Mapping[str, Any]) -> None:
        if event in _CONNECTED:
            self._keep(info["return_value"].get_extra_info("socket"))


class HttpServer:
    """A server that is asked over HTTP, by several threads at once."""

    def __init__(self, address: Address, name: str = "") -> None:
        self.address = address
        self._exchanges = Exchanges(name or address.model or address.host)
        self._client = httpx.Client(
            verify=_trusted(address.url),
            trust_env=False,  # no proxy: what is said to a robot takes no detour
            limits=httpx.Limits(max_keepalive_connections=0),
        )

    @property
    def closed(self) -> bool:
        """True once it was closed."""
        return self._exchanges.closed

    @contextmanager
    def request(
        self,
        route: str,
        deadline_s: float,
        token: CancelToken,
        *,
        most_bytes: int = MOST_BYTES,
        **sends: Any,
    ) -> Iterator[HttpRequest]:
        """A request whose status is good, or one that was cancelled.

        `sends` are httpx's arguments, such as ``json``. Raises `ServerFailed`.
        """
        url, headers = self.address.route(route), self.address.headers()
        one = HttpRequest(
            self._client, url, headers, sends, deadline_s=deadline_s, most_bytes=most_bytes
        )
        self._exchanges.begin(one)
        forget = token.on_cancel(one.drop)
        try:
            status = one.status()
            if status not in (0, HTTPStatus.OK):
                raise by_status(status, url, refusal(one.reply()), later=one.later)
            self.refuse_if_closed(token)
            yield one
        finally:
            forget()
            one.drop()

    def lives(self, token: CancelToken) -> bool:
        """Whether it answers within `LOOK_S`."""
        return is_alive(lambda: self.read_json("models", time.monotonic() + LOOK_S, token))

    def read_json(self, route: str, deadline_s: float, token: CancelToken) -> Any:
        """A whole reply in JSON; None if cancelled. Raises `ServerFailed`."""
        with self.request(route, deadline_s, token) as one:
            reply = one.reply()
        if token.cancelled:
            return None
        try:
            return read_json(reply, route)
        except InvalidValue:
            raise Unusable(f"{self.address.route(route)} did not answer in JSON") from None

    def refuse_if_closed(self, token: CancelToken | None = None) -> None:
        """Raise `Unreachable` if it was closed while nobody cancelled."""
        if not (token and token.cancelled):
            self._exchanges.refuse_if_closed()

    def close(self) -> None:
        """End all requests and their threads."""
        self._exchanges.close()
        self._client.close()


def refusal(reply: bytes) -> str:
    """Why a request was refused, as far as the server says."""
    try:
        found = read_json(reply, "reply")
        return message_of(found.get("error", found))
    except (InvalidValue, AttributeError):
        return " ".join(reply[:200].decode("utf-8", "replace").split())


def message_of(problem: Any) -> str:
    """What an error object says, in a line's length."""
    said = problem.get("message", problem) if isinstance(problem, dict) else problem
    return " ".join(str(said).split())[:200]


def _trusted(url: str) -> ssl.SSLContext:
    """The system's certificates, to which a company may have added its own; none if none are used.

    To load them takes a tenth of a second.
    """
    if url.startswith("https:"):
        return ssl.create_default_context()
    return ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
