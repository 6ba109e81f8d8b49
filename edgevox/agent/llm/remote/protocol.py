"""The OpenAI protocol: a server's address and offer, the form of a request, and errors.

An error says by its class what helps: a second attempt, another request, or nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from edgevox.agent.llm.language_model import ChatMessage, ModelBusy, ModelFailed
from edgevox.core.files.user_file import regular
from edgevox.core.settings import GrammarDialect


class Unreachable(ModelFailed):
    """The server cannot be reached or serve now; a second attempt may succeed."""


class Unusable(ModelFailed):
    """The server answers wrongly, and would answer the same request the same way."""


class RequestRefused(ModelFailed):
    """The server refused this request, perhaps as too long; it may serve others."""


_OF_THE_REQUEST = (400, 413, 422)
_FOR_NOW = (408, 425)
_FULL, _AWAY = 429, 503


def by_status(status: int, route: str, said: str, *, later: bool = False) -> ModelFailed:
    """The error that an HTTP status other than 200 stands for.

    `later` is whether the server says when to come again, by which a 503 means that it is full and
    not that it is gone. A full one is not tried again: who waits in its queue would wait twice.
    """
    message = f"{route} answered {status}: {said}"
    if status == _FULL or (status == _AWAY and later):
        return ModelBusy(message)
    if status in _OF_THE_REQUEST:
        return RequestRefused(message)
    return Unreachable(message) if status in _FOR_NOW or status >= 500 else Unusable(message)


_OWNERS: Mapping[str, GrammarDialect] = {"llamacpp": "llama-server", "vllm": "vllm"}
"""What servers call themselves in their list of models."""
_LONGEST_KEY = 4096


@dataclass(frozen=True, slots=True)
class Address:
    """One server. `url` is its root or its ``/v1``; an empty `model` is the first that it offers.

    `timeout_s` is the longest wait for the first token, attempts and pauses included, and for each
    later one. The key is read from its file for every request, so that it can be renewed.
    """

    url: str
    model: str = ""
    timeout_s: float = 10.0
    key_file: Path | None = None
    dialect: GrammarDialect = "auto"

    @property
    def host(self) -> str:
        """What to call it in a log."""
        return urlsplit(self.url).netloc

    def route(self, name: str) -> str:
        """The address of one of its services."""
        root = self.url.rstrip("/")
        return f"{root}/{name}" if root.endswith("/v1") else f"{root}/v1/{name}"

    def headers(self) -> dict[str, str]:
        """What goes with every request. Raises `Unusable` if there is no key to be had."""
        # What is compressed could be small on the wire and fill the memory.
        plain = {"Accept-Encoding": "identity", "Connection": "close"}
        if self.key_file is None:
            return plain
        try:
            with open(self.key_file, encoding="ascii", opener=regular) as file:
                key = file.read(_LONGEST_KEY + 1).strip()
        except (OSError, UnicodeDecodeError):
            raise Unusable(f"llm_endpoint_key_file: {self.key_file} cannot be read") from None
        if not 0 < len(key) <= _LONGEST_KEY or not key.isprintable() or " " in key:
            raise Unusable(f"llm_endpoint_key_file: {self.key_file} does not hold one key")
        return plain | {"Authorization": f"Bearer {key}"}


@dataclass(frozen=True, slots=True)
class Offer:
    """What a server said that it has: the model to ask for, and how it takes a grammar."""

    model: str
    dialect: GrammarDialect


def read_offer(reply: Any, address: Address) -> Offer:
    """From the server's list of models. Raises `Unusable` if it is none."""
    try:
        first = reply["data"][0]
        model, owner = str(first["id"]), str(first.get("owned_by", ""))
    except (KeyError, IndexError, TypeError, AttributeError):
        raise Unusable(f"{address.host} does not say which models it has") from None
    found = _OWNERS.get(owner, "none") if address.dialect == "auto" else address.dialect
    return Offer(address.model or model, found)


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
    match offer.dialect if grammar is not None else "none":
        case "llama-server":
            request |= {"grammar": grammar, "cache_prompt": True}
        case "vllm":
            request |= {"structured_outputs": {"grammar": grammar}}
        case "vllm-guided":
            request |= {"guided_grammar": grammar}
    return request
