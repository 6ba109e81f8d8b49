"""The fallback: the embedded model answers while the shared one cannot."""

from collections.abc import Iterator, Sequence

from edgevox.agent.llm.language_model import (
    ChatMessage,
    LanguageModel,
    ModelBusy,
    ModelFailed,
)
from edgevox.agent.llm.remote.remote_model import EndpointModel
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.errors import ServerBusy, ServerFailed
from edgevox.core.servers.health import Breaker, ServerHealth

ON_BOARD = "the model on board"


class FallbackModel:
    """Implements `LanguageModel` by a shared model and, if there is one, the one on board.

    An answer that has begun is not begun again by the other: it fails. A server that is full is
    asked again by the next question: it has not failed.
    """

    def __init__(
        self, shared: EndpointModel, on_board: LanguageModel | None, breaker: Breaker | None = None
    ) -> None:
        self._shared = shared
        self._on_board = on_board
        self.context_tokens = shared.context_tokens
        if on_board is not None:
            self.context_tokens = min(self.context_tokens, on_board.context_tokens)
        self.name = shared.name
        self.health = ServerHealth("llm", shared.name, ON_BOARD if on_board else "nothing", breaker)

    @property
    def fault(self) -> str:
        """The reason why the shared model rests; empty once it answers again."""
        return self.health.fault

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        begun = False
        if not self.health.resting:
            try:
                for piece in self._shared.generate(
                    messages, grammar=grammar, max_tokens=max_tokens, token=token
                ):
                    if not begun:
                        begun = True
                        self.health.works()
                    yield piece
            except ServerFailed as error:
                self.health.fails(error)
                if begun or self._on_board is None:
                    raise _model_failed(error) from error
            else:
                return
        if token.cancelled:
            return
        if self._on_board is None:
            raise ModelFailed(f"{self.name} did not answer a moment ago and is not asked again yet")
        self.health.fallbacks += 1
        yield from self._on_board.generate(
            messages, grammar=grammar, max_tokens=max_tokens, token=token
        )

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """Both read the messages, so that neither keeps anybody waiting later."""
        try:
            self._shared.prime(messages, token)
        except ServerFailed as error:
            self.health.fails(error)
        if self._on_board is not None:
            self._on_board.prime(messages, token)

    def count_tokens(self, text: str) -> int:
        """As many as the more wasteful of the two makes of it."""
        shared = self._shared.count_tokens(text)
        return max(shared, self._on_board.count_tokens(text)) if self._on_board else shared

    def close(self) -> None:
        """See `LanguageModel.close`."""
        self._shared.close()
        if self._on_board is not None:
            self._on_board.close()


def _model_failed(error: ServerFailed) -> ModelFailed:
    return (ModelBusy if isinstance(error, ServerBusy) else ModelFailed)(str(error))
