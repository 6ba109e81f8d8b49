"""The interface of language models, their errors, and a stand-in for a missing model."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError

CONTEXT_TOKENS = 4096
"""Room for instructions, examples, history and answer, unless a caller says otherwise."""


class ModelFailed(EdgeVoxError):
    """A language model could not be loaded or could not answer; the message says why."""


class ModelBusy(ModelFailed):
    """The model works but has no room for this question; it may answer a later one."""


@dataclass(frozen=True, slots=True)
class ChatMessage:
    """A message of a chat."""

    role: Literal["system", "user", "assistant"]
    content: str


class LanguageModel(Protocol):
    """A model that answers chats in a language that a GBNF grammar describes.

    Calls from several threads are served one after the other.
    """

    name: str
    context_tokens: int

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """Yield pieces of the answer as they are decoded; greedy, so the same chat repeats.

        Ends early, within one token, when `token` is cancelled or the iterator is closed; while the
        prompt is being read, within one batch of it. Raises `ModelFailed`.
        """

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """Read these messages now, so that a chat that begins with them is answered sooner."""

    def count_tokens(self, text: str) -> int:
        """Number of tokens of this text."""

    def close(self) -> None:
        """Free the model's memory and end its threads; what is being generated ends with them."""


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
