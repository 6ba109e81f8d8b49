"""A language model that runs on a server of the network, by the OpenAI protocol.

`EndpointModel` asks the server; `FallbackModel` lets the embedded model answer while that cannot.
Servers differ in which fields they take; a request that is refused for one is sent without it. They
answer with a stream of events or a whole reply, with thoughts or without.
"""

import time
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import chain
from typing import Any

from edgevox.agent.llm.gbnf import enforce_grammar
from edgevox.agent.llm.language_model import (
    CONTEXT_TOKENS,
    ChatMessage,
    LanguageModel,
    ModelBusy,
    ModelFailed,
)
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import read_json
from edgevox.core.servers.address import Address, first_that, listed
from edgevox.core.servers.errors import RequestRefused, ServerBusy, ServerFailed, Unreachable
from edgevox.core.servers.health import Breaker, ServerHealth
from edgevox.core.servers.http import HttpServer, message_of
from edgevox.core.settings import GrammarDialect

_DONE = "[DONE]"
_LONGEST_LINE = 1 << 18
_THOUGHTS = (
    ("<think>", "</think>"),
    ("<thinking>", "</thinking>"),
    ("<thought>", "</thought>"),
    ("[THINK]", "[/THINK]"),
)
"""Marks around what a reasoning model thinks before it answers."""
_REASONING = ("reasoning_content", "reasoning")
"""Fields of thoughts, on servers that keep them apart from the answer."""
_LONGEST_MARK = max(len(mark) for pair in _THOUGHTS for mark in pair)


def pieces(chunks: Iterable[bytes]) -> Iterator[str]:
    """The answer's text as it comes; an empty piece for a thought, which is a sign of life.

    A server that does not stream sends the whole answer at once, which is one piece. Raises
    `Unreachable` for a stream that ends before the answer does, and for all that is none.
    """
    rest = iter(chunks)
    began = b""
    while not began.strip() and (chunk := next(rest, None)) is not None:
        began += chunk
    if began.lstrip().startswith(b"{"):
        yield _whole(b"".join(chain([began], rest)))
        return
    ended = False
    for data in _data(chain([began], rest)):
        if data == _DONE:
            return
        piece, thought, last = _read(data)
        ended = ended or last
        if piece or thought:
            yield piece
    if not ended:
        raise Unreachable("the connection broke before the answer was whole")


def answered(heard: Iterable[str]) -> Iterator[str]:
    """An answer without the white space and the thoughts before it."""
    stream = iter(heard)
    held = ""
    for piece in stream:
        held += piece
        held, known = _after_thoughts(held)
        if known:
            break
    if held:
        yield held
    yield from (piece for piece in stream if piece)


def _after_thoughts(held: str) -> tuple[str, bool]:
    """What of the beginning counts, and whether that is certain."""
    text = held.lstrip()
    for begins, ends in _THOUGHTS:
        if text.startswith(begins):
            _, closed, after = text.partition(ends)
            if not closed:  # no more is kept than tells the end
                return begins + text[len(begins) :][-_LONGEST_MARK:], False
            return _after_thoughts(after)
        if begins.startswith(text):
            return text, False
    return text, True


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


def _read(data: str) -> tuple[str, bool, bool]:
    """The text of one event, whether it is a thought, and whether no other has any text."""
    try:
        event: Any = read_json(data, "event")
        if problem := event.get("error"):
            raise Unreachable(f"the server failed while it answered: {message_of(problem)}")
        if not (choices := event.get("choices")):
            return "", False, False
        delta = choices[0].get("delta") or {}
        thought = any(delta.get(one) for one in _REASONING)
        return _text(delta.get("content")), thought, choices[0].get("finish_reason") is not None
    except (InvalidValue, AttributeError, LookupError, TypeError):
        raise _no_answer(data) from None


def _whole(reply: bytes) -> str:
    """The text of a reply that is not streamed."""
    data = reply.decode("utf-8", "replace")
    try:
        found: Any = read_json(data, "reply")
        if problem := found.get("error"):
            raise Unreachable(f"the server failed while it answered: {message_of(problem)}")
        return _text(found["choices"][0]["message"].get("content"))
    except (InvalidValue, AttributeError, LookupError, TypeError):
        raise _no_answer(data) from None


def _text(content: Any) -> str:
    """Text, or a list of parts of which some are text. Raises `TypeError` for all others."""
    match content:
        case None:
            return ""
        case str():
            return content
        case list():
            texts = (one.get("text") for one in content if one.get("type", "text") == "text")
            return "".join(_text(one) for one in texts)
        case _:
            raise TypeError(content)


def _no_answer(data: str) -> Unreachable:
    return Unreachable(f"not an answer of a language model: {data[:80]!r}")


_OWNERS: Mapping[str, GrammarDialect] = {"llamacpp": "llama-server", "vllm": "vllm"}
"""What servers call themselves in their list of models."""
_NO_THOUGHTS = {"chat_template_kwargs": {"enable_thinking": False}}
"""A robot's answer must not wait for a thousand tokens of reasoning, where a template can do so."""
_OTHER_NAMES = {"max_tokens": "max_completion_tokens"}
_DISPENSABLE = ("temperature", "chat_template_kwargs", "cache_prompt")


@dataclass(frozen=True, slots=True)
class Offer:
    """What a server said that it has: the model to ask for, and how it takes a grammar."""

    model: str
    dialect: GrammarDialect


def read_offer(reply: Any, address: Address, dialect: GrammarDialect = "auto") -> Offer:
    """From the server's list of models: the named one, else the first that chats.

    Raises `Unusable` if it is no list, or if none of its models chats.
    """
    entry = listed(reply, address)[0] if address.model else first_that("chat", reply, address)
    owner = str(entry.get("owned_by", ""))
    found = _OWNERS.get(owner, "none") if dialect == "auto" else dialect
    return Offer(address.model or str(entry["id"]), found)


def chat_request(
    offer: Offer, messages: Sequence[ChatMessage], grammar: str | None, max_tokens: int
) -> dict[str, Any]:
    """The body of a request for one streamed answer, greedy."""
    request: dict[str, Any] = {
        "model": offer.model,
        "messages": [{"role": m.role, "content": m.content} for m in messages],
        "max_tokens": max_tokens,
        "stream": True,
        "temperature": 0.0,
    }
    if offer.dialect != "none":
        request |= _NO_THOUGHTS
    match offer.dialect if grammar is not None else "none":
        case "llama-server":
            request |= {"grammar": grammar, "cache_prompt": True}
        case "vllm":
            request |= {"structured_outputs": {"grammar": grammar}}
        case "vllm-guided":
            request |= {"guided_grammar": grammar}
    return request


def refused_field(request: Mapping[str, Any], said: str) -> str:
    """The field of a request that a refusal names, if the request can do without; else empty."""
    fields = (*_OTHER_NAMES, *_DISPENSABLE)
    return next((one for one in fields if one in request and one in said), "")


def without_fields(request: Mapping[str, Any], refused: frozenset[str]) -> dict[str, Any]:
    """The request without these fields, or with their other names."""
    kept = {name: value for name, value in request.items() if name not in refused}
    renamed = {_OTHER_NAMES[one]: request[one] for one in refused & _OTHER_NAMES.keys()}
    return kept | renamed


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


ON_BOARD = "the model on board"


class FallbackModel:
    """Implements `LanguageModel` by a shared model and, if there is one, the one on board.

    An answer that has begun is not begun again by the other: it fails. A server that is full is
    asked again by the next question: it has not failed.
    """

    def __init__(
        self, shared: EndpointModel, on_board: LanguageModel | None, breaker: Breaker | None = None
    ) -> None:
        self._shared = shared
        self._on_board = on_board
        self.context_tokens = shared.context_tokens
        if on_board is not None:
            self.context_tokens = min(self.context_tokens, on_board.context_tokens)
        self.name = shared.name
        self.health = ServerHealth("llm", shared.name, ON_BOARD if on_board else "nothing", breaker)

    @property
    def fault(self) -> str:
        """The reason why the shared model rests; empty once it answers again."""
        return self.health.fault

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        begun = False
        if not self.health.resting:
            try:
                for piece in self._shared.generate(
                    messages, grammar=grammar, max_tokens=max_tokens, token=token
                ):
                    if not begun:
                        begun = True
                        self.health.works()
                    yield piece
            except ServerFailed as error:
                self.health.fails(error)
                if begun or self._on_board is None:
                    raise _model_failed(error) from error
            else:
                return
        if token.cancelled:
            return
        if self._on_board is None:
            raise ModelFailed(f"{self.name} did not answer a moment ago and is not asked again yet")
        self.health.fallbacks += 1
        yield from self._on_board.generate(
            messages, grammar=grammar, max_tokens=max_tokens, token=token
        )

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """Both read the messages, so that neither keeps anybody waiting later."""
        try:
            self._shared.prime(messages, token)
        except ServerFailed as error:
            self.health.fails(error)
        if self._on_board is not None:
            self._on_board.prime(messages, token)

    def count_tokens(self, text: str) -> int:
        """As many as the more wasteful of the two makes of it."""
        shared = self._shared.count_tokens(text)
        return max(shared, self._on_board.count_tokens(text)) if self._on_board else shared

    def close(self) -> None:
        """See `LanguageModel.close`."""
        self._shared.close()
        if self._on_board is not None:
            self._on_board.close()


def _model_failed(error: ServerFailed) -> ModelFailed:
    return (ModelBusy if isinstance(error, ServerBusy) else ModelFailed)(str(error))
