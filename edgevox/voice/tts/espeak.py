"""espeak-ng: plain, tiny, and at home in every language; what speaks when nothing better can."""

import shutil
from collections.abc import Iterator
from typing import Protocol

from edgevox.core.cancel import CancelToken
from edgevox.core.log import get_logger
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.kana import kana
from edgevox.voice.tts.synthesiser import SynthesisFailed

log = get_logger(__name__)

COMMAND = "espeak-ng"


class EspeakEngine(Protocol):
    """espeak-ng, however it is reached. May be used from any thread."""

    sample_rate_hz: int

    def speak(self, text: str, language: str, token: CancelToken) -> Chunk:
        """The text as sound; cut short once the token is cancelled. Raises `SynthesisFailed`."""


class EspeakSynthesiser:
    """A language of espeak-ng, by its name there (``en-us``, ``cmn``)."""

    phrase_chars = 400

    def __init__(self, engine: EspeakEngine, language: str) -> None:
        self._engine = engine
        self._language = language
        self.sample_rate_hz = engine.sample_rate_hz

    def warm_up(self) -> None:
        self._engine.speak("1", self._language, CancelToken())

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        if token.cancelled:
            return
        text = kana(sentence) if self._language == "ja" else sentence
        chunk = self._engine.speak(text, self._language, token)
        if len(chunk.samples) and not token.cancelled:
            yield chunk


def open_espeak() -> EspeakEngine:
    """The library of the espeakng-loader wheel, else the command on this machine.

    Raises `SynthesisFailed` if there is neither.
    """
    try:
        from edgevox.voice.tts.espeak_library import espeak_library

        return espeak_library()
    except (ImportError, OSError, RuntimeError, SynthesisFailed) as error:
        log.info("espeak_library_missing", reason=str(error), instead=COMMAND)
    path = shutil.which(COMMAND)
    if path is None:
        raise SynthesisFailed(
            "espeak: there is no espeak-ng; expected the package espeakng-loader, "
            "or the command espeak-ng on PATH"
        )
    from edgevox.voice.tts.espeak_command import EspeakCommand

    return EspeakCommand(path)
