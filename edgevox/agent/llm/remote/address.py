"""The address of a shared model, its offer, and the form of its requests."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from edgevox.agent.llm.language_model import ChatMessage
from edgevox.agent.llm.remote.server_errors import Unusable
from edgevox.core.files.user_file import regular
from edgevox.core.settings import GrammarDialect

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
