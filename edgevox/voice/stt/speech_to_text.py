"""The interface of a speech-to-text engine, and a watch over it that tells of its failures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Hypothesis
from edgevox.voice.audio import Samples


@dataclass(frozen=True, slots=True)
class Transcript:
    """The words in a sound, empty if there are none, and how sure it is that they are those.

    `others` are what else may have been said, the likeliest first.
    """

    text: str
    confidence: float = 1.0
    others: tuple[Hypothesis, ...] = ()


class SpeechToText(Protocol):
    """Understands one utterance at a time, on the caller's thread."""

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """The words in this sound at 16 kHz, in a language by its ISO 639-1 code.

        Raises `EdgeVoxError` if the language's model is not here.
        """

    def warm_up(self, language: str) -> None:
        """Load what the language needs, so that the first utterance does not wait for it."""

    def close(self) -> None: ...


TELL_EVERY_S = 20.0
"""Noise is taken for speech now and then: a robot must not lament all day."""


class WatchedSpeechToText:
    """A `SpeechToText` around another one that watches for faults.

    `tell` is called, at limited intervals, when an utterance was lost to a fault.
    """

    def __init__(self, stt: SpeechToText, clock: Clock | None = None) -> None:
        self.tell: Callable[[], None] = lambda: None
        self.fault = ""
        """The reason why nothing is understood now; empty after a success."""
        self._stt = stt
        self._clock = clock or SystemClock()
        self._told_s = float("-inf")

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """See `SpeechToText.transcribe`."""
        try:
            heard = self._stt.transcribe(samples, language)
        except Exception as error:
            self._lament(error)
            raise
        self.fault = ""
        return heard

    def warm_up(self, language: str) -> None:
        """See `SpeechToText.warm_up`."""
        try:
            self._stt.warm_up(language)
        except Exception as error:
            self._lament(error)
            raise
        self.fault = ""

    def close(self) -> None:
        """See `SpeechToText.close`."""
        self._stt.close()

    def _lament(self, error: Exception) -> None:
        self.fault = " ".join(str(error).split()) or type(error).__name__
        now_s = self._clock.now()
        if now_s - self._told_s >= TELL_EVERY_S:
            self._told_s = now_s
            self.tell()
