"""What a language model is told: its role, examples, and the chat so far.

`History` keeps the chat within the context window. `PromptPrefill` has the model read the opening
in advance, while the robot already obeys plain commands.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from edgevox.agent.llm.language_model import ChatMessage, LanguageModel, ModelFailed
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.core.cancel import CancelToken
from edgevox.core.log import get_logger

log = get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Shown:
    """An example of a chat: a sentence, and the answer to it."""

    asked: str
    says: str


def talk_prompt(instructions: str, language: str = ENGLISH) -> str:
    """The role, and how to answer questions about the world in general, in that language."""
    unknown = phrasebook(language).say("not_known")
    rule = f'Answer in one short sentence. If you cannot know it, say "{unknown}"'
    return "\n".join([instructions, "", rule, *_spoken_in(language)])


def everyday(language: str = ENGLISH) -> Sequence[Shown]:
    """Examples of questions that have an answer, and of such that have none."""
    book = phrasebook(language)
    unknown = book.say("not_known")
    return [Shown(one.asked, one.answer or unknown) for one in book.everyday]


def _spoken_in(language: str) -> list[str]:
    if language == ENGLISH:
        return []
    name = phrasebook(language).name
    return [f"People speak {name} to you. Every sentence that you say is {name}."]


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
