"""The stand-in for a language model that was asked for but could not be loaded."""

from collections.abc import Iterator, Sequence

from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage, ModelFailed
from edgevox.core.cancel import CancelToken


class AbsentModel:
    """Implements `LanguageModel`: it never answers, and says why.

    So a robot without its model starts, obeys plain commands, and says why it cannot do more.
    """

    name = "none"

    def __init__(self, fault: str, *, context_tokens: int = CONTEXT_TOKENS) -> None:
        self.fault = fault
        self.context_tokens = context_tokens

    def generate(
        self,
        messages: Sequence[ChatMessage],  # noqa: ARG002 - whatever it is asked
        *,
        grammar: str | None,  # noqa: ARG002
        max_tokens: int,  # noqa: ARG002
        token: CancelToken,  # noqa: ARG002
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        raise ModelFailed(self.fault)

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """There is nothing to be read into."""

    def count_tokens(self, text: str) -> int:  # noqa: ARG002
        """Any text fits."""
        return 0

    def close(self) -> None:
        """There is nothing to be freed."""
