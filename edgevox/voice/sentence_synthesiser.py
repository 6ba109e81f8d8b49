"""Sentences to sound with the voice of the moment, and with another one if it fails."""

from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import Said, get_logger, worth_a_line
from edgevox.voice.audio import Chunk
from edgevox.voice.spoken_answer import SpeakingUtterance, silent_end_s
from edgevox.voice.spoken_text import normalise_for_speech, split_phrases
from edgevox.voice.tts.synthesiser import Synthesiser
from edgevox.voice.tts.voices import VoiceChoice

log = get_logger(__name__)

Voices = Callable[[], Sequence[VoiceChoice]]
"""The voice that is to be used now, and after it those to be tried when it fails; maybe none."""


class Pool(Protocol):
    """A source of loaded voices."""

    def get(self, choice: VoiceChoice) -> Synthesiser:
        """The voice, loaded and warm. Raises what its engine raises."""


class SentenceSynthesiser:
    """Synthesises sentences with the wanted voice, and with another one if that fails.

    It looks up the voice before every sentence, so a change is heard with the next one. Used from
    one thread, except for its properties. `failures` counts failed syntheses.
    """

    def __init__(self, voices: Voices, pool: Pool, *, clock: Clock | None = None) -> None:
        self._voices = voices
        self._pool = pool
        self._clock = clock or SystemClock()
        self.failures = 0
        self.last: tuple[VoiceChoice, int] | None = None
        """The voice that spoke last or was prepared, and its rate in hertz."""
        self.fault = ""
        """The reason why the last sentence was not spoken; empty if it was."""

    def prepare(self) -> None:
        """Load the present voice; what fails is logged, and the next one is loaded."""
        choices = self._voices()
        fine = any(self._load(choice) for choice in choices)
        self.fault = "" if fine else _no_voice(choices)

    def speak(self, utterance: SpeakingUtterance, line: int, sentence: str) -> Iterator[Chunk]:
        """The sound of one sentence, piece by piece, until the utterance is cut."""
        choices = self._voices()
        if not choices:
            self.fault = _no_voice(choices)
            return
        language = LANGUAGES[choices[0].language]
        left = normalise_for_speech(sentence, language.code)
        for choice in choices:
            if not left or utterance.token.cancelled:
                break
            utterance.log.expect(line, len(left), spaced=language.spaced)
            left = yield from self._speak_with(choice, left, utterance, line)
        if not utterance.token.cancelled:
            self.fault = _no_voice(choices) if left else ""
        if not left:
            utterance.log.complete(line)

    def _speak_with(
        self, choice: VoiceChoice, text: str, utterance: SpeakingUtterance, line: int
    ) -> Generator[Chunk, None, str]:
        """Speak with one voice; the text that is left, if it fails."""
        engine = self._load(choice)
        if engine is None:
            return text
        waiting = split_phrases(text, engine.phrase_chars)
        while waiting and not utterance.token.cancelled:
            fine = yield from self._phrase(choice, engine, waiting[0], utterance, line)
            if not fine:
                break
            utterance.log.said(line, len(waiting.pop(0)))
        return " ".join(waiting)

    def _phrase(
        self,
        choice: VoiceChoice,
        engine: Synthesiser,
        text: str,
        utterance: SpeakingUtterance,
        line: int,
    ) -> Generator[Chunk, None, bool]:
        """The sound of one phrase; False if the engine failed."""
        pieces = iter(engine.synthesise(text, utterance.token))
        while True:
            began_s = self._clock.now()
            try:
                chunk = next(pieces, None)
            except Exception:
                self.failures += 1
                if worth_a_line(self.failures):
                    log.exception("voice_failed", voice=choice.name, text=Said(text))
                return False
            if chunk is None:
                return True
            utterance.synthesis_s += self._clock.now() - began_s
            utterance.log.made(line, len(chunk.samples) / chunk.rate_hz, silent_end_s(chunk))
            yield chunk

    def _load(self, choice: VoiceChoice) -> Synthesiser | None:
        try:
            engine = self._pool.get(choice)
        except EdgeVoxError as error:
            self.failures += 1
            if worth_a_line(self.failures):
                log.error("voice_not_loaded", voice=choice.name, reason=str(error))  # noqa: TRY400
            return None
        self.last = (choice, engine.sample_rate_hz)
        return engine


def _no_voice(choices: Sequence[VoiceChoice]) -> str:
    tried = ", ".join(choice.name for choice in choices)
    return f"no voice speaks: {tried} failed" if tried else "no voice is on this machine"
