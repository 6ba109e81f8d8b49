"""One exchange: what it is cancelled by, how long its stages took, and what is answered in it."""

from collections.abc import Callable

from sentence_stream import SentenceBoundaryDetector

from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.events import Responded, SentenceReady, TokenGenerated, TurnMeasured


class Turn:
    """Owns a `CancelToken` and a stopwatch, and speaks the turn's answer onto the bus.

    `on_speech` is called before the first sentence. Nothing is said once the token is cancelled.
    """

    def __init__(self, number: int, bus: Bus, clock: Clock, on_speech: Callable[[], None]) -> None:
        self.number = number
        self.token = CancelToken()
        self._bus = bus
        self._clock = clock
        self._on_speech = on_speech
        self._sentences = SentenceBoundaryDetector()
        self._said: list[str] = []
        self._started_s = clock.now()
        self._first_s: float | None = None
        self._model_s = 0.0

    @property
    def text(self) -> str:
        """What has been said so far, in whole sentences."""
        return " ".join(self._said)

    def stream(self, piece: str) -> None:
        """Say a piece of an answer as a model generates it."""
        if self.token.cancelled or not piece:
            return
        self._bus.publish(TokenGenerated(piece, self.number))
        for sentence in self._sentences.add_chunk(piece):
            self._say(sentence)

    def say(self, text: str) -> None:
        """Say a whole text."""
        for sentence in self._sentences.add_chunk(text + " "):
            self._say(sentence)
        self.flush()

    def flush(self) -> None:
        """The answer, or this part of it, is complete: say what was held back for its end."""
        rest = self._sentences.finish().strip()
        if rest:
            self._say(rest)

    def thought(self, seconds: float) -> None:
        """Count time that a model worked for this turn."""
        self._model_s += seconds

    def finish(self, *, measured: bool) -> None:
        """Publish the full answer, if there was any, and what the turn took if `measured`."""
        if not self.token.cancelled:
            self.flush()
        if self._said:
            self._bus.publish(Responded(self.text, self.number, cut=self.token.cancelled))
        if not measured:
            return
        total = self._clock.now() - self._started_s
        first = total if self._first_s is None else self._first_s
        self._bus.publish(
            TurnMeasured(
                stt=0.0, llm=self._model_s, tts=0.0, ttfs=first, total=total, turn=self.number
            )
        )

    def _say(self, sentence: str) -> None:
        if self.token.cancelled:
            return
        if self._first_s is None:
            self._first_s = self._clock.now() - self._started_s
            self._on_speech()
        self._said.append(sentence)
        self._bus.publish(SentenceReady(sentence, self.number))
