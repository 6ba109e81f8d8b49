"""Holds what a server sends against the grammar that it was asked to obey."""

from collections.abc import Iterable, Iterator

from edgevox.agent.llm.endpoint.server_errors import Unusable
from edgevox.agent.llm.gbnf import Matcher
from edgevox.core.cancel import CancelToken


def enforce_grammar(
    answer: Iterable[str], grammar: str | None, token: CancelToken
) -> Iterator[str]:
    """The pieces of an answer as far as they obey; what is said after its end is left out.

    Raises `Unusable` for one that leaves the grammar before its end, and for an empty one.
    """
    if grammar is None:
        yield from answer
        return
    matcher, begun = Matcher(grammar), False
    for piece in answer:
        count = matcher.accept(piece)
        if count:
            begun = True
            yield piece[:count]
        if count < len(piece):
            if matcher.complete:
                return
            raise Unusable(f"it does not obey the grammar: {piece[:80]!r}")
    if not begun and not token.cancelled:
        raise Unusable("its answer is empty")
