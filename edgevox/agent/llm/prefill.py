"""The prefill: a model reads a chat's opening while the robot already obeys plain commands."""

import threading
from collections.abc import Callable, Sequence

from edgevox.agent.llm.language_model import ChatMessage, LanguageModel, ModelFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.log import get_logger

log = get_logger(__name__)


class PromptPrefill:
    """Primes a model on a thread of its own.

    Plain commands never need the model, so they do not wait for this. A sentence for the model that
    comes meanwhile waits for the rest of the priming and is answered sooner because of it. `after`
    blocks until more urgent work is done.
    """

    def __init__(
        self,
        model: LanguageModel,
        messages: Sequence[ChatMessage],
        *,
        after: Callable[[], None] | None = None,
    ) -> None:
        self._model = model
        self._messages = messages
        self._after = after
        self._token = CancelToken()
        self._thread = threading.Thread(target=self._work, name="edgevox-prefill")

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Stop reading and wait for the thread."""
        self._token.cancel("shutting down")
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> None:
        if self._after:
            self._after()
        if self._token.cancelled:
            return
        try:
            self._model.prime(self._messages, self._token)
        except ModelFailed as error:
            log.error("model_not_primed", reason=str(error))  # noqa: TRY400 - its message says it all
