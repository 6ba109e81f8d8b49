"""The words of a language model: it says only what claims nothing, and of which it is sure."""

import re
from collections.abc import Callable, Sequence

from edgevox.agent.llm.language_model import ChatMessage, LanguageModel, Piece
from edgevox.agent.llm.protocol import OutputParser
from edgevox.agent.turn import Turn

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


def say_by(
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
