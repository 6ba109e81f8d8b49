"""A language model that runs on a server of the network."""

import ssl
import threading
import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from http import HTTPStatus
from typing import Any

import httpx

from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage, ModelFailed
from edgevox.agent.llm.remote.gbnf import enforce_grammar
from edgevox.agent.llm.remote.http import HttpRequest, pieces, refusal
from edgevox.agent.llm.remote.protocol import (
    Address,
    Offer,
    Unreachable,
    Unusable,
    by_status,
    chat_request,
    read_offer,
)
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.files.json_reader import read_json

PAUSES_S = (0.2, 0.6)
"""Before the second and the third attempt."""
_MOST_WAITS = 6
"""A whole answer may take this many times what its first token may."""


class EndpointModel:
    """Implements `LanguageModel`, though several calls are served at once.

    A request that fails is tried again until its first token is there, within the time for that.
    What the server sends is held against the grammar, whether or not the server knows of it:
    nothing else comes through.
    """

    def __init__(
        self,
        address: Address,
        *,
        context_tokens: int = CONTEXT_TOKENS,
        pauses_s: Sequence[float] = PAUSES_S,
    ) -> None:
        self.name = address.model or address.host
        self.context_tokens = context_tokens
        self._address = address
        self._pauses_s = pauses_s
        self._offer: Offer | None = None
        self._closed = threading.Event()
        self._lock = threading.Lock()
        self._exchanges: set[HttpRequest] = set()
        self._client = httpx.Client(
            verify=_trusted(address.url),
            trust_env=False,  # no proxy: what is said to a robot takes no detour
            limits=httpx.Limits(max_keepalive_connections=0),
        )

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        deadline_s = time.monotonic() + self._address.timeout_s
        pauses, begun = iter(self._pauses_s), False
        while not token.cancelled:
            try:
                with closing(
                    self._attempt(messages, grammar, max_tokens, deadline_s, token)
                ) as heard:
                    for piece in enforce_grammar(heard, grammar, token):
                        begun = True
                        yield piece
                        if token.cancelled:
                            return
            except Unreachable:
                self._offer = None  # whoever answers next may be somebody else
                pause_s = next(pauses, None)
                late = pause_s is None or time.monotonic() + pause_s >= deadline_s
                if begun or late or self._closed.is_set():
                    raise
                token.wait(pause_s)
            else:
                return

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """See `LanguageModel.prime`."""
        for _ in self.generate(messages, grammar=None, max_tokens=1, token=token):
            pass

    def count_tokens(self, text: str) -> int:
        """Rather more than any tokenizer makes of it; the server is not asked.

        Two letters a token, every digit and sign one, and two for a character beyond ASCII.
        """
        plain = sum(one.isascii() for one in text)
        letters = sum(one.isascii() and (one.isalpha() or one == " ") for one in text)
        return (letters + 1) // 2 + (plain - letters) + 2 * (len(text) - plain)

    def close(self) -> None:
        """See `LanguageModel.close`."""
        self._closed.set()
        with self._lock:
            left = list(self._exchanges)
        for one in left:
            one.drop()
        for one in left:
            one.join()
        self._client.close()

    def _attempt(
        self,
        messages: Sequence[ChatMessage],
        grammar: str | None,
        max_tokens: int,
        deadline_s: float,
        token: CancelToken,
    ) -> Generator[str, None, None]:
        """The answer to one request."""
        offer = self._offer or self._ask_offer(deadline_s, token)
        if offer is None:
            return
        self._offer = offer
        body = chat_request(offer, messages, grammar, max_tokens)
        end_s = deadline_s + (_MOST_WAITS - 1) * self._address.timeout_s
        with self._exchange("chat/completions", body, deadline_s, token) as exchange:
            try:
                for piece in pieces(exchange.chunks()):
                    yield piece
                    exchange.deadline_s = min(end_s, time.monotonic() + self._address.timeout_s)
            except Unreachable:
                if not token.cancelled:
                    self._refuse_if_closed()
                    raise

    def _ask_offer(self, deadline_s: float, token: CancelToken) -> Offer | None:
        """What the server has; None if cancelled."""
        address = self._address
        if address.model and address.dialect != "auto":
            return Offer(address.model, address.dialect)
        with self._exchange("models", None, deadline_s, token) as exchange:
            reply = b"".join(exchange.chunks())
        if token.cancelled:
            return None
        try:
            return read_offer(read_json(reply, "models"), address)
        except InvalidValue:
            raise Unusable(f"{address.route('models')} did not answer in JSON") from None

    @contextmanager
    def _exchange(
        self, route: str, body: Mapping[str, Any] | None, deadline_s: float, token: CancelToken
    ) -> Iterator[HttpRequest]:
        """A request whose status is good, or one that was cancelled."""
        url = self._address.route(route)
        with self._lock:
            self._refuse_if_closed()
            self._exchanges = {one for one in self._exchanges if one.running}
            exchange = HttpRequest(self._client, url, self._address.headers(), body, deadline_s)
            self._exchanges.add(exchange)
        forget = token.on_cancel(exchange.drop)
        try:
            status = exchange.status()
            if status not in (0, HTTPStatus.OK):
                said = refusal(b"".join(exchange.chunks()))
                raise by_status(status, url, said, later=exchange.later)
            self._refuse_if_closed(token)
            yield exchange
        finally:
            forget()
            exchange.drop()

    def _refuse_if_closed(self, token: CancelToken | None = None) -> None:
        if self._closed.is_set() and not (token and token.cancelled):
            raise ModelFailed(f"{self.name} is closed")


def _trusted(url: str) -> ssl.SSLContext:
    """The system's certificates, to which a company may have added its own; none if none are used.

    To load them takes a tenth of a second.
    """
    if url.startswith("https:"):
        return ssl.create_default_context()
    return ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
