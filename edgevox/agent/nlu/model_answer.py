"""The words of a language model: it says only what claims nothing, and of which it is sure."""

import re
from collections.abc import Callable, Collection, Sequence

from edgevox.agent.agents import Agent
from edgevox.agent.llm.language_model import (
    ChatMessage,
    LanguageModel,
    ModelBusy,
    ModelFailed,
    Piece,
)
from edgevox.agent.llm.prompt import History, size_tokens
from edgevox.agent.llm.protocol import OutputParser, Protocol
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.turn import Turn
from edgevox.core.clock import Clock
from edgevox.core.events import Outcome
from edgevox.core.log import get_logger

log = get_logger(__name__)

ANSWER_TOKENS = 160
"""Number of tokens that a model may generate for an answer."""

LEAST_LIKELY = 0.15
"""A model is not sure of an answer with a less likely word. By `benchmarks.agent.everyday`, on the
half for tuning."""

_SENTENCE_END = re.compile(r"(?<=[.!?\u061f\u0964])\s+|(?<=[\u3002\uff01\uff1f])")


class CheckedAnswer:
    """Lets the sentences of a model's answer pass that make no claim and of which it is sure.

    It is not if a piece is less likely than `LEAST_LIKELY`.
    """

    def __init__(self, claims: Callable[[str], bool]) -> None:
        self._claims = claims
        self._sure = True
        self._pieces: list[str] = []
        self.dropped = False
        """True if a sentence was held back; what follows it is held back as well."""

    def feed(self, piece: str, likely: float = 1.0) -> list[str]:
        """The pieces of the sentences that ended in this one and may be said."""
        self._sure = self._sure and (not piece or likely >= LEAST_LIKELY)
        self._pieces.append(piece)
        *ended, rest = _SENTENCE_END.split("".join(self._pieces))
        return self._passed(ended, rest) if ended else []

    def finish(self) -> list[str]:
        """The pieces of the last sentence, if it may be said."""
        return self._passed(["".join(self._pieces)], "") if self._pieces else []

    def _passed(self, sentences: Sequence[str], rest: str) -> list[str]:
        pieces, self._pieces = self._pieces, [rest]
        told: list[str] = []
        for one in sentences:
            self.dropped = self.dropped or not self._sure or (bool(one) and self._claims(one))
            if self.dropped:
                return told
            told.append(f"{one} ")
        return [*pieces[:-1], pieces[-1].removesuffix(rest)]


class ModelTalk:
    """What a language model is told, says and remembers, for several agents. One thread uses it.

    Without a model it only tells what one would read.
    """

    def __init__(
        self,
        model: LanguageModel | None,
        agents: Sequence[Agent],
        phrases: Phrasebook,
        clock: Clock,
    ) -> None:
        self._model = model
        self._agents = agents
        self._clock = clock
        self.set_language(phrases)
        self._history = History(self._count_tokens, self._history_budget())

    @property
    def here(self) -> bool:
        """True if there is a model."""
        return self._model is not None

    def set_language(self, phrases: Phrasebook) -> None:
        """Have it talk this language from now on."""
        self._phrases = phrases
        self._protocols = {
            one.name: Protocol(one.instructions, one.handoffs, phrases.code) for one in self._agents
        }

    def chat(self, agent: Agent, text: str = "") -> list[ChatMessage]:
        """The messages that the model would see for this utterance."""
        return self._chat(self._protocols[agent.name], text)

    def answer(
        self,
        agent: Agent,
        had: Collection[str],
        text: str,
        turn: Turn,
        claims: Callable[[str], bool],
    ) -> str:
        """Say what passes of the model's answer; return the agent that it hands over to, or "".

        It hands over to none of those that `had` it. `claims` tells which sentences claim what no
        model knows.
        """
        if self._model is None:
            return ""
        protocol, started_s = self._protocols[agent.name].without(had), self._clock.now()
        try:
            name = _say_by(
                self._model,
                self._chat(protocol, text),
                protocol.grammar,
                turn,
                CheckedAnswer(claims),
            )
        except ModelFailed as error:
            log.error("model_failed", reason=str(error))  # noqa: TRY400 - its message says it all
            what = "model_busy" if isinstance(error, ModelBusy) else "model_failed"
            turn.say(self._phrases.say(what), Outcome.FAILED)
            return ""
        finally:
            turn.thought(self._clock.now() - started_s)
        return name if name in protocol.handoffs else ""

    def remember(self, agent: Agent, said: str, turn: Turn) -> None:
        """Add a question and its answer to what the model sees."""
        answer = self._protocols[agent.name].render(turn.text)
        self._history.add(said, answer, cut=turn.cut)

    def forget(self) -> None:
        """Clear the history."""
        self._history.clear()

    def _chat(self, protocol: Protocol, text: str) -> list[ChatMessage]:
        said = [ChatMessage("user", text)] if text else []
        return [*protocol.opening, *self._history.messages(), *said]

    def _count_tokens(self, text: str) -> int:
        return self._model.count_tokens(text) if self._model else 0

    def _history_budget(self) -> int:
        if self._model is None:
            return 0
        longest = max(
            size_tokens(self._count_tokens, one.opening) for one in self._protocols.values()
        )
        return max(0, self._model.context_tokens - longest - 4 * ANSWER_TOKENS)


def _say_by(
    model: LanguageModel,
    chat: Sequence[ChatMessage],
    grammar: str,
    turn: Turn,
    checked: CheckedAnswer,
) -> str:
    """Say what passes of what the model writes; return the agent that it hands over to, or "".

    Raises `ModelFailed`.
    """
    parser = OutputParser()
    for piece in model.generate(chat, grammar=grammar, max_tokens=ANSWER_TOKENS, token=turn.token):
        likely = piece.likely if isinstance(piece, Piece) else 1.0
        turn.stream("")
        for told in checked.feed(parser.feed(piece), likely):
            turn.stream(told, tokens=0)
    for told in checked.finish():
        turn.stream(told, tokens=0)
    turn.flush()
    return "" if turn.token.cancelled else parser.finish()
