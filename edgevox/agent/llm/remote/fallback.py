"""The fallback: the embedded model answers while the shared one cannot.

`Breaker` leaves a failed server alone for a while.
"""

import threading
from collections.abc import Iterator, Sequence

from edgevox.agent.llm.language_model import (
    ChatMessage,
    LanguageModel,
    ModelBusy,
    ModelFailed,
)
from edgevox.agent.llm.remote.protocol import RequestRefused
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger

log = get_logger(__name__)


FIRST_REST_S, LONGEST_REST_S = 15.0, 240.0


class Breaker:
    """A circuit breaker: each failure on end doubles the rest, one success ends it."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._lock = threading.Lock()
        self._rest_s = 0.0
        self._until_s = 0.0

    @property
    def resting(self) -> bool:
        """True while it is too early to try again."""
        return self._rest_s > 0 and self._clock.now() < self._until_s

    def failed(self) -> bool:
        """Record a failure; True for the first of a row."""
        with self._lock:
            first = self._rest_s == 0
            self._rest_s = FIRST_REST_S if first else min(2 * self._rest_s, LONGEST_REST_S)
            self._until_s = self._clock.now() + self._rest_s
            return first

    def succeeded(self) -> bool:
        """Record a success; True if the last attempt had failed."""
        with self._lock:
            recovered = self._rest_s > 0
            self._rest_s = 0.0
            return recovered


class FallbackModel:
    """Implements `LanguageModel` by a shared model and, if there is one, the one on board.

    An answer that has begun is not begun again by the other: it fails. A server that is full is
    asked again by the next question: it has not failed.
    """

    def __init__(
        self, shared: LanguageModel, on_board: LanguageModel | None, breaker: Breaker | None = None
    ) -> None:
        self._shared = shared
        self._on_board = on_board
        self._breaker = breaker or Breaker()
        models = [shared] if on_board is None else [shared, on_board]
        self._models = models
        self.name = shared.name
        self.context_tokens = min(one.context_tokens for one in models)
        self.fault = ""
        """The reason why the shared model rests; empty once it answers again."""
        self.fallbacks = 0
        """Chats that the one on board had to answer."""
        self.turned_away = 0
        """Chats for which the shared model had no room."""
        self._full = False

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
        if not self._breaker.resting:
            try:
                for piece in self._shared.generate(
                    messages, grammar=grammar, max_tokens=max_tokens, token=token
                ):
                    if not begun:
                        begun = True
                        self._works()
                    yield piece
            except ModelFailed as error:
                self._fails(error)
                if begun or self._on_board is None:
                    raise
            else:
                return
        if token.cancelled:
            return
        if self._on_board is None:
            raise ModelFailed(f"{self.name} did not answer a moment ago and is not asked again yet")
        self.fallbacks += 1
        yield from self._on_board.generate(
            messages, grammar=grammar, max_tokens=max_tokens, token=token
        )

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """Both read the messages, so that neither keeps anybody waiting later."""
        try:
            self._shared.prime(messages, token)
        except ModelFailed as error:
            self._fails(error)
        if self._on_board is not None:
            self._on_board.prime(messages, token)

    def count_tokens(self, text: str) -> int:
        """As many as the more wasteful of the two makes of it."""
        return max(one.count_tokens(text) for one in self._models)

    def close(self) -> None:
        """See `LanguageModel.close`."""
        for one in self._models:
            one.close()

    def _works(self) -> None:
        self.fault = ""
        if self._breaker.succeeded():
            log.warning("model_server_back", server=self.name)
        self._full = False

    def _fails(self, error: ModelFailed) -> None:
        instead = "the model on board" if self._on_board else "nothing"
        if isinstance(error, ModelBusy):
            self.turned_away += 1
            if not self._full:
                log.warning(
                    "model_server_full", server=self.name, reason=str(error), instead=instead
                )
            self._full = True
            return
        if isinstance(error, RequestRefused):
            log.warning("model_server_refused", server=self.name, reason=str(error))
            return
        self.fault = str(error)
        if self._breaker.failed():
            log.warning("model_server_failed", server=self.name, reason=str(error), instead=instead)
