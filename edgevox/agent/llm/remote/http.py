"""HTTP requests on threads of their own, so that a caller can always stop waiting.

`pieces` reads the server-sent events of a chat, as OpenAI-compatible servers send them.
"""

import contextlib
import socket
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from queue import Empty, SimpleQueue
from typing import Any

import httpx

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.remote.protocol import Unreachable, Unusable
from edgevox.core.errors import InvalidValue
from edgevox.core.files.json_reader import read_json

_DONE = "[DONE]"
_LONGEST_LINE = 1 << 18


def pieces(chunks: Iterable[bytes]) -> Iterator[str]:
    """The answer's text as it comes.

    Raises `Unreachable` for a stream that ends before the answer does, and for all that is none.
    """
    ended = False
    for data in _data(chunks):
        if data == _DONE:
            return
        piece, last = _read(data)
        ended = ended or last
        if piece:
            yield piece
    if not ended:
        raise Unreachable("the connection broke before the answer was whole")


def _data(chunks: Iterable[bytes]) -> Iterator[str]:
    """What follows ``data:`` on a line; comments and other fields are passed over."""
    rest = b""
    for chunk in chunks:
        *lines, rest = (rest + chunk).split(b"\n")
        if len(rest) > _LONGEST_LINE:
            raise Unreachable("not a stream of events: a line without end")
        for line in lines:
            name, _, value = line.decode("utf-8", "replace").strip().partition(":")
            if name in ("data", "error"):
                yield value.strip()


def _read(data: str) -> tuple[str, bool]:
    """The text of one event, and whether it is the last one with any."""
    try:
        event: Any = read_json(data, "event")
        if problem := event.get("error"):
            raise Unreachable(f"the server failed while it answered: {_message(problem)}")
        if not (choices := event.get("choices")):
            return "", False
        text = choices[0].get("delta", {}).get("content") or ""
        return str(text), choices[0].get("finish_reason") is not None
    except (InvalidValue, AttributeError, LookupError, TypeError):
        raise Unreachable(f"not an answer of a language model: {data[:80]!r}") from None


def _message(problem: Any) -> str:
    """What an error object says, in a line's length."""
    said = problem.get("message", problem) if isinstance(problem, dict) else problem
    return " ".join(str(said).split())[:200]


def refusal(reply: bytes) -> str:
    """Why a request was refused, as far as the server says."""
    try:
        found = read_json(reply, "reply")
        return _message(found.get("error", found))
    except (InvalidValue, AttributeError):
        return " ".join(reply[:200].decode("utf-8", "replace").split())


MOST_BYTES = 4 << 20
"""A longer reply than this is not an answer; 160 tokens take some 60 kB."""
_CONNECT_S = 3.0
_SILENCE_S = 120.0
"""Seconds of silence that end a connection which was not dropped; its reader has a deadline too."""
_CONNECTED = ("connection.connect_tcp.complete", "connection.start_tls.complete")


class HttpRequest:
    """A request that is sent when it is made. Read `status`, then `chunks`; always `drop` it.

    `deadline_s`, in `time.monotonic`, ends the wait for more; the reader may move it. No server can
    hold up the reader: not by names that do not resolve, a connection that hangs, or headers that
    trickle in. `drop` closes the connection, which tells the server to stop.
    """

    def __init__(
        self,
        client: httpx.Client,
        url: str,
        headers: Mapping[str, str],
        body: Mapping[str, Any] | None,
        deadline_s: float,
    ) -> None:
        self.deadline_s = deadline_s
        self.later = False
        """True if the server said when to try again; known once `status` is."""
        self._client = client
        self._request = client.build_request(
            "GET" if body is None else "POST",
            url,
            headers=dict(headers),
            json=body,
            timeout=httpx.Timeout(_SILENCE_S, connect=_CONNECT_S),
            extensions={"trace": self._trace},
        )
        self._lock = threading.Lock()
        self._dropped = False
        self._socket: socket.socket | None = None
        self._heard: SimpleQueue[int | bytes | ModelFailed | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="edgevox-endpoint")
        self._thread.start()

    def status(self) -> int:
        """The HTTP status; 0 if it was dropped. Raises `ModelFailed`."""
        first = self._next()
        if isinstance(first, int):
            return first
        if not self._dropped:
            raise Unreachable("the connection ended without a word")
        return 0

    def chunks(self) -> Iterator[bytes]:
        """The reply as it comes, to its end or until it is dropped. Raises `ModelFailed`."""
        while isinstance(chunk := self._next(), bytes):
            yield chunk

    def drop(self) -> None:
        """Close the connection; `chunks` ends. Any thread may say so."""
        with self._lock:
            self._dropped = True
            self._hang_up()
        self._heard.put(None)

    def join(self) -> None:
        """Wait for the thread of one that was dropped."""
        self._thread.join()

    @property
    def running(self) -> bool:
        """True while the thread is alive."""
        return self._thread.is_alive()

    def _next(self) -> int | bytes | None:
        left_s = self.deadline_s - time.monotonic()
        try:
            item = self._heard.get(timeout=left_s) if left_s > 0 else self._too_late()
        except Empty:
            item = self._too_late()
        if self._dropped:
            return None
        if isinstance(item, ModelFailed):
            raise item
        return item

    def _too_late(self) -> ModelFailed:
        return Unreachable("no answer in time")

    def _run(self) -> None:
        try:
            self._receive()
        except (httpx.HTTPError, OSError) as error:
            self._heard.put(Unreachable(str(error) or type(error).__name__))
        finally:
            self._heard.put(None)

    def _receive(self) -> None:
        response = self._client.send(self._request, stream=True)
        size = 0
        try:
            self.later = "retry-after" in response.headers
            self._heard.put(response.status_code)
            for chunk in response.iter_raw():
                size += len(chunk)
                if self._dropped:
                    return
                if size > MOST_BYTES:
                    self._heard.put(Unusable(f"a reply of more than {MOST_BYTES >> 20} MiB"))
                    return
                self._heard.put(chunk)
        finally:
            response.close()

    def _trace(self, event: str, info: Mapping[str, Any]) -> None:
        """Keep the socket: to shut it down is all that wakes a thread that reads from it."""
        if event in _CONNECTED:
            with self._lock:
                self._socket = info["return_value"].get_extra_info("socket")
                if self._dropped:
                    self._hang_up()

    def _hang_up(self) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):  # it may be closed already
                socket.socket.shutdown(self._socket, socket.SHUT_RDWR)
