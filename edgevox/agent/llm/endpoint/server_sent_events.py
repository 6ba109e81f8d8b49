"""Server-sent events of a chat, as OpenAI-compatible servers send them."""

from collections.abc import Iterable, Iterator
from typing import Any

from edgevox.agent.llm.endpoint.server_errors import Unreachable
from edgevox.core.errors import InvalidValue
from edgevox.core.json_reader import read_json

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
