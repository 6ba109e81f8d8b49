"""The interface of language models, their errors, and a stand-in for a missing model.

`LlmComponent` is the status of the model that answers, on board or on a server.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol, Self

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.servers.health import ServerHealth
from edgevox.core.status import (
    ComponentName,
    Finding,
    Gauges,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    fault_of,
)

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


class Piece(str):
    """A piece of an answer, with how likely the model found it, from 0 to 1."""

    likely: float

    def __new__(cls, text: str, likely: float) -> Self:
        piece = super().__new__(cls, text)
        piece.likely = likely
        return piece


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

        Each is a `Piece` where the engine tells how likely it is.
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


class LlmComponent:
    """A server that is gone is a warning while the model on board answers, else an error.

    `weights` is the file of the model on board, None if there is none, and `absent` why there is
    none though one was asked for. `endpoint` is the server's address, empty without one.
    """

    name = ComponentName.LLM

    def __init__(
        self,
        model: LanguageModel,
        gauges: Gauges,
        *,
        weights: Path | None = None,
        endpoint: str = "",
        absent: str = "",
        clock: Clock | None = None,
    ) -> None:
        self._model, self._gauges, self._endpoint, self._absent = model, gauges, endpoint, absent
        self._on_board = weights.name if weights else None
        self._failing = RecentIncrease(clock)
        self.checks = (HealthCheck("llm", lambda: absent, vital=False),) if absent else ()

    def status(self) -> Status:
        """The status now."""
        fault, failed, found = fault_of(self._model), self._gauges.model_failures, []
        if self._absent:
            found.append(Finding(Level.ERROR, f"the model on board is missing: {self._absent}"))
        if fault:
            level = Level.WARN if self._on_board else Level.ERROR
            instead = "the model on board answers" if self._on_board else "nothing answers"
            which = self._endpoint or "the model"
            found.append(Finding(level, f"{which} fails: {fault}; {instead}"))
        if self._failing.grew(failed):
            text = f"an answer failed, {failed} by now; the log says why"
            found.append(Finding(Level.ERROR, text))
        server: ServerHealth | None = getattr(self._model, "health", None)
        return Status.judged(
            self.name,
            found,
            well="thinks",
            model=self._on_board,
            endpoint=self._endpoint or None,
            answers="on board" if fault or not self._endpoint else "endpoint",
            context_tokens=self._model.context_tokens,
            tokens_per_s=self._gauges.tokens_per_s,
            failed=failed,
            **(server.figures() if server else {}),
        )
