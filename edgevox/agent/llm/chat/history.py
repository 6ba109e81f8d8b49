"""The history of a chat, kept within the model's context window."""

from collections.abc import Callable, Sequence

from edgevox.agent.llm.language_model import ChatMessage

CUT_MARK = " [interrupted]"
"""Ends an answer in the history that the person did not hear to its end."""

_OVERHEAD_TOKENS = 8
"""Number of tokens that a chat template adds to each message, rounded up."""


def size_tokens(count_tokens: Callable[[str], int], messages: Sequence[ChatMessage]) -> int:
    """Number of tokens of these messages in a context window, with those of the chat template."""
    return sum(count_tokens(message.content) + _OVERHEAD_TOKENS for message in messages)


class History:
    """Exchanges, oldest first. The oldest half is forgotten when they outgrow `budget_tokens`.

    Half at once, not one by one: a model keeps what it computed for the part of a chat that did not
    change, and every forgotten exchange changes the chat from its start.
    """

    def __init__(self, count_tokens: Callable[[str], int], budget_tokens: int) -> None:
        self._count = count_tokens
        self._budget = budget_tokens
        self._exchanges: list[tuple[ChatMessage, ChatMessage]] = []
        self._sizes: list[int] = []

    def add(self, said: str, answered: str, *, cut: bool = False) -> None:
        """Remember one exchange."""
        exchange = (
            ChatMessage("user", said),
            ChatMessage("assistant", answered + CUT_MARK if cut else answered),
        )
        self._exchanges.append(exchange)
        self._sizes.append(size_tokens(self._count, exchange))
        while self._exchanges and sum(self._sizes) > self._budget:
            half = (len(self._exchanges) + 1) // 2
            del self._exchanges[:half]
            del self._sizes[:half]

    def clear(self) -> None:
        self._exchanges.clear()
        self._sizes.clear()

    def messages(self) -> Sequence[ChatMessage]:
        return [message for exchange in self._exchanges for message in exchange]
