"""What a speech-to-text engine must offer."""

from typing import Protocol

from edgevox.voice.audio import Samples


class SpeechToText(Protocol):
    """Understands one utterance at a time, on the caller's thread."""

    def transcribe(self, samples: Samples, language: str) -> str:
        """The words in this sound at 16 kHz, in a language by its ISO 639-1 code.

        Empty if there are none. Raises `EdgeVoxError` if the language's model is not here.
        """

    def warm_up(self, language: str) -> None:
        """Load what the language needs, so that the first utterance does not wait for it."""

    def close(self) -> None: ...
