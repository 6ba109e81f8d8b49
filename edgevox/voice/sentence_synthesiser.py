"""Sentences to sound with the voice of the moment, and with another one if it fails.

Before that, text is made fit to be spoken: no markup, no addresses, no pictures, numbers that read
well. A long sentence is split into phrases, so that its first words are heard while the rest is
synthesised.
"""

import re
import unicodedata
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from typing import Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import Said, get_logger, worth_a_line
from edgevox.core.servers.errors import ServerFailed
from edgevox.voice.audio import Chunk
from edgevox.voice.spoken_answer import SpeakingUtterance, silent_end_s
from edgevox.voice.tts.synthesiser import Synthesiser
from edgevox.voice.tts.voices import SERVER, VoiceChoice

log = get_logger(__name__)

_CLAUSE = re.compile(r"(?<=[,;:—–،؛])\s+|(?<=[、，；：])")  # noqa: RUF001
_LEAST_CHARS = 12
_LONGEST_CHARS = 240
_WIDE = "\N{CJK RADICAL REPEAT}"
"""From this character on, each is a syllable or a word, and counts as three."""


def split_phrases(sentence: str, length: int) -> list[str]:
    """The sentence in pieces of about `length` characters that end where a speaker may pause.

    A sentence that is not longer stays whole. Nothing is lost but the spaces between the pieces. A
    piece without a comma may be longer, but never beyond what any engine takes at once.
    """
    pieces = _join([part for part in _CLAUSE.split(sentence) if part.strip()], length)
    return [short for piece in pieces for short in _halves(piece.strip())]


def _join(clauses: list[str], length: int) -> list[str]:
    """Clauses put together again, as long as they stay short or would be too short alone."""
    pieces: list[str] = []
    for clause in clauses:
        if pieces and (
            _size(pieces[-1]) + _size(clause) < length
            or min(_size(pieces[-1]), _size(clause)) < _LEAST_CHARS
        ):
            pieces[-1] = _glue(pieces[-1], clause)
        else:
            pieces.append(clause)
    return pieces


def _glue(left: str, right: str) -> str:
    """Full-width marks are written without a space after them."""
    return f"{left}{right}" if left[-1] in "、，；：" else f"{left} {right}"  # noqa: RUF001


def _halves(piece: str) -> list[str]:
    """The piece, in parts at spaces if it is far too long."""
    if _size(piece) <= _LONGEST_CHARS:
        return [piece]
    most = _LONGEST_CHARS * len(piece) // _size(piece)
    at = piece.rfind(" ", 1, most)
    at = at if at > 0 else most
    return [piece[:at].strip(), *_halves(piece[at:].strip())]


def _size(text: str) -> int:
    """About how long it takes to say, in letters."""
    return sum(3 if character >= _WIDE else 1 for character in text)


_FENCE = re.compile(r"```.*?(```|$)", re.DOTALL)
_LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
_ADDRESS = re.compile(r"(?:https?://|www\.)(?:www\.)?([\w-]+(?:\.[\w-]+)+)\S*")
_BULLET = re.compile(r"(?m)^\s*(?:[-*+•]|#{1,6}|>)\s+")
_MARKUP = re.compile(r"[*`~|<>{}\\^]+|__+|(?<!\w)_+|_+(?!\w)|(?m:^\s*-{3,}\s*$)")
_JOINED = re.compile(r"(?<=\w)_(?=\w)")
_COORDINATE = re.compile(r"\b([xyz])\s*=?\s*(-?)(?=\d)", re.IGNORECASE)
_MINUS = re.compile(r"(?<![\w.])-(?=\d)")
_DASH = "-"
_JOINERS = "\N{ZERO WIDTH JOINER}\N{VARIATION SELECTOR-16}"
_PICTURES = ("So", "Sk", "Cs", "Co", "Cn")


def normalise_for_speech(text: str, language: str = "en") -> str:
    """The text as it should be spoken, on one line; empty if there is nothing to say in it."""
    text = _FENCE.sub(" ", text)
    text = _LINK.sub(r"\1", text)
    text = _ADDRESS.sub(r"\1", text)
    text = _BULLET.sub("", text)
    text = _in_words(text, LANGUAGES[language].signs)
    text = _JOINED.sub(" ", _MARKUP.sub("", text))
    text = "".join(" " if _is_picture(c) else c for c in text)
    text = re.sub(r"\s+([,.;:!?])", r"\1", " ".join(text.split()))
    return text if any(c.isalnum() for c in text) else ""


def _in_words(text: str, signs: Mapping[str, str]) -> str:
    """Signs that an engine would swallow, in words."""
    minus = f"{signs[_DASH]} "
    text = _COORDINATE.sub(lambda m: f"{m[1]} {minus if m[2] else ''}", text)
    text = _MINUS.sub(minus, text)
    for sign, words in signs.items():
        text = text if sign == _DASH else text.replace(sign, f" {words} ")
    return text


def _is_picture(character: str) -> bool:
    kind = unicodedata.category(character)
    return character in _JOINERS or kind in _PICTURES or kind == "Cc"


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
        """Load the present voice; what fails is logged, and the next one is loaded.

        Behind a server's voice one on board is loaded, too: a fallback must not wait for it.
        """
        choices = self._voices()
        first: tuple[VoiceChoice, int] | None = None
        for choice in choices:
            if self._load(choice):
                first = first or self.last
                if choice.backend != SERVER:
                    break
        self.last = first or self.last
        self.fault = "" if first else _no_voice(choices)

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
            except ServerFailed:
                return False  # its health has told it
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
