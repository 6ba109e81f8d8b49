"""The OpenAI protocol: a server's offer, and the form of a request.

Servers differ in which fields they take; a request that is refused for one is sent without it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from edgevox.agent.llm.language_model import ChatMessage
from edgevox.core.servers.address import Address
from edgevox.core.servers.offer import first_that, listed
from edgevox.core.settings import GrammarDialect

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
