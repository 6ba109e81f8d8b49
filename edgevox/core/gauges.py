"""Gauges: readings that components take from the bus, of loudness and of the last turns."""

from edgevox.core.bus import Bus
from edgevox.core.events import AudioLevel, Outcome, TokenGenerated, TurnEnded, TurnMeasured


class Gauges:
    """The last value of each reading; None before the first. Any thread may read."""

    def __init__(self, bus: Bus) -> None:
        self.level: float | None = None
        """Loudness of the microphone, root mean square, 0 to 1."""
        self.synthesis_s: float | None = None
        """Seconds of speech synthesis for the last spoken answer."""
        self.first_audio_s: float | None = None
        """Seconds from the input to the first audible sample of that answer."""
        self.tokens_per_s: float | None = None
        """Tokens per second of the last answer by a model; reading the prompt counts as well."""
        self.model_failures = 0
        """Number of turns that failed after a language model had worked for them."""
        self._thought_s = 0.0
        self._tokens = 0
        self._forget = [
            bus.subscribe(AudioLevel, self._on_level),
            bus.subscribe(TokenGenerated, self._on_token),
            bus.subscribe(TurnMeasured, self._on_measured),
            bus.subscribe(TurnEnded, self._on_ended),
        ]

    def close(self) -> None:
        """Stop listening to the bus."""
        for forget in self._forget:
            forget()

    def _on_level(self, event: AudioLevel) -> None:
        self.level = event.level

    def _on_token(self, _: TokenGenerated) -> None:
        self._tokens += 1

    def _on_measured(self, event: TurnMeasured) -> None:
        self._thought_s = event.llm
        if event.tts:
            self.synthesis_s, self.first_audio_s = event.tts, event.ttfs

    def _on_ended(self, event: TurnEnded) -> None:
        thought_s, self._thought_s = self._thought_s, 0.0
        tokens, self._tokens = self._tokens, 0
        if thought_s and tokens:
            self.tokens_per_s = tokens / thought_s
        self.model_failures += bool(thought_s) and event.outcome is Outcome.FAILED
