"""A language model that runs on a server of the network."""

import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing
from typing import Any

from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage
from edgevox.agent.llm.remote.answer import answered, pieces
from edgevox.agent.llm.remote.gbnf import enforce_grammar
from edgevox.agent.llm.remote.protocol import (
    Offer,
    chat_request,
    read_offer,
    refused_field,
    without_fields,
)
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import RequestRefused, Unreachable
from edgevox.core.servers.http import HttpServer
from edgevox.core.settings import GrammarDialect

PAUSES_S = (0.2, 0.6)
"""Before the second and the third attempt."""
_MOST_WAITS = 6
"""A whole answer may take this many times what its first token may."""


class EndpointModel:
    """A model that answers as a `LanguageModel` does, though several calls are served at once.

    A request that fails is tried again until its first token is there, within the time for that. A
    field that the server refuses is left out from then on. What the server sends is held against
    the grammar, whether or not the server knows of it: nothing else comes through. Raises
    `ServerFailed`; `FallbackModel` makes a `LanguageModel` of it.
    """

    def __init__(
        self,
        address: Address,
        *,
        dialect: GrammarDialect = "auto",
        context_tokens: int = CONTEXT_TOKENS,
        pauses_s: Sequence[float] = PAUSES_S,
    ) -> None:
        self.name = address.model or address.host
        self.context_tokens = context_tokens
        self._address = address
        self._dialect = dialect
        self._pauses_s = pauses_s
        self._offer: Offer | None = None
        self._refused: frozenset[str] = frozenset()
        self._server = HttpServer(address)

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`. Raises `ServerFailed`."""
        deadline_s = time.monotonic() + self._address.timeout_s
        pauses, begun = iter(self._pauses_s), False
        while not token.cancelled:
            try:
                with closing(
                    self._attempt(messages, grammar, max_tokens, deadline_s, token)
                ) as heard:
                    for piece in enforce_grammar(answered(heard), grammar, token):
                        begun = True
                        yield piece
                        if token.cancelled:
                            return
            except Unreachable:
                self._offer = None  # whoever answers next may be somebody else
                pause_s = next(pauses, None)
                late = pause_s is None or time.monotonic() + pause_s >= deadline_s
                if begun or late or self._server.closed:
                    raise
                token.wait(pause_s)
            else:
                return

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """See `LanguageModel.prime`. Raises `ServerFailed`."""
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
        self._server.close()

    def _attempt(
        self,
        messages: Sequence[ChatMessage],
        grammar: str | None,
        max_tokens: int,
        deadline_s: float,
        token: CancelToken,
    ) -> Generator[str, None, None]:
        """The answer to one question, asked again without each field that the server refuses."""
        offer = self._offer or self._ask_offer(deadline_s, token)
        if offer is None:
            return
        self._offer = offer
        full = chat_request(offer, messages, grammar, max_tokens)
        while True:
            request = without_fields(full, self._refused)
            try:
                yield from self._asked(request, deadline_s, token)
            except RequestRefused as error:
                refused = refused_field(request, str(error))
                if not refused:
                    raise
                self._refused |= {refused}
            else:
                return

    def _asked(
        self, request: Mapping[str, Any], deadline_s: float, token: CancelToken
    ) -> Iterator[str]:
        """The answer to one request."""
        end_s = deadline_s + (_MOST_WAITS - 1) * self._address.timeout_s
        with self._server.request("chat/completions", deadline_s, token, json=request) as exchange:
            try:
                for piece in pieces(exchange.chunks()):
                    yield piece
                    exchange.deadline_s = min(end_s, time.monotonic() + self._address.timeout_s)
            except Unreachable:
                if not token.cancelled:
                    self._server.refuse_if_closed()
                    raise

    def _ask_offer(self, deadline_s: float, token: CancelToken) -> Offer | None:
        """What the server has; None if cancelled."""
        if self._address.model and self._dialect != "auto":
            return Offer(self._address.model, self._dialect)
        reply = self._server.read_json("models", deadline_s, token)
        return None if token.cancelled else read_offer(reply, self._address, self._dialect)
