"""The interface of a speech-to-text engine."""

from dataclasses import dataclass
from typing import Protocol

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
