"""What servers send as an answer: a stream of events or a whole reply, with thoughts or without."""

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.core.files.json_reader import read_json
from edgevox.core.servers.errors import Unreachable
from edgevox.core.servers.http import message_of

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
