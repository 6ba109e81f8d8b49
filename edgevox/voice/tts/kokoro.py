"""Kokoro: one model of 82 million parameters with 54 voices of nine languages.

`Phonemes` makes its input: phonemes, as tokens of its vocabulary.
"""

import logging
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from kokoro_onnx.tokenizer import Tokenizer
from kokoro_onnx.trim import trim
from numpy.typing import NDArray
from phonemizer import phonemize  # type: ignore[import-untyped]

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk
from edgevox.voice.tts.espeak import kana
from edgevox.voice.tts.synthesiser import SynthesisFailed, open_session, to_samples

LANGUAGE_CODES = {
    "a": "en-us",
    "b": "en-gb",
    "e": "es",
    "f": "fr-fr",
    "h": "hi",
    "i": "it",
    "j": "ja",
    "p": "pt-br",
    "z": "cmn",
}
"""espeak-ng's language, by the first letter of a voice's name."""


_JAPANESE = str.maketrans("ɽɹ", "ɾɾ", "ˈˌᵝ\N{COMBINING DIAERESIS}\N{COMBINING DOWN TACK BELOW}")
_DOUBLED = {"tt": "ʔt", "pp": "ʔp", "kk": "ʔk"}  # noqa: RUF001
"""Kokoro's spelling of doubled consonants, by espeak-ng's."""
_SWITCH = re.compile(r"\([a-z]{2,3}(?:-[a-z]+)?\)")
"""espeak-ng's marks around a foreign word: ``(en)`` before and ``(fr)`` after it."""


class Phonemes:
    """Text to tokens: read by espeak-ng, but Chinese by misaki, whose tones the model learnt."""

    def __init__(self) -> None:
        logging.getLogger("phonemizer").setLevel(logging.ERROR)  # it warns of each foreign word
        self._tokenizer = Tokenizer()
        self._chinese: Any = None

    def tokens(self, text: str, voice: str) -> list[int]:
        """The text's tokens for a voice of this name; empty if nothing of it is known.

        Raises `ImportError` if what the language needs is not installed.
        """
        phonemes = self._phonemes(" ".join(text.split()), LANGUAGE_CODES[voice[0]])
        return list(self._tokenizer.tokenize(phonemes, limit=None))

    def _phonemes(self, text: str, code: str) -> str:
        if code == "cmn":
            return self._read_chinese(text)
        if code == "ja":
            return self._read_japanese(text)
        return _SWITCH.sub("", str(self._tokenizer.phonemize(text, code)))

    def _read_chinese(self, text: str) -> str:
        if self._chinese is None:
            import_module("jieba").setLogLevel(logging.WARNING)
            self._chinese = import_module("misaki.zh").ZHG2P()
        phonemes, _ = self._chinese(text)
        return str(phonemes)

    def _read_japanese(self, text: str) -> str:
        """Convert Japanese to phonemes by espeak-ng.

        Marks that Kokoro has no tokens for are left out.
        """
        read = phonemize(
            kana(text), "ja", backend="espeak", preserve_punctuation=True, with_stress=True
        )
        letters = unicodedata.normalize("NFD", str(read)).translate(_JAPANESE)
        phonemes = unicodedata.normalize("NFC", letters)
        for doubled, learnt in _DOUBLED.items():
            phonemes = phonemes.replace(doubled, learnt)
        return phonemes


THREADS = 2
SAMPLE_RATE_HZ = 24_000
_MOST_TOKENS = 510
_STYLE_SHAPE = (_MOST_TOKENS, 1, 256)
_SENTENCE_PAUSE_S, _PHRASE_PAUSE_S = 0.25, 0.1
_SENTENCE_ENDS = tuple(".!?。！？।…")  # noqa: RUF001


@dataclass(frozen=True, slots=True)
class Style:
    """A voice: its name and, for a text of n tokens, its style in row n - 1."""

    name: str
    rows: NDArray[np.float32]


def load_style(folder: Path, name: str) -> Style:
    """A voice from ``voices/<name>.bin`` in the folder of all voices."""
    values = np.fromfile(folder / "voices" / f"{name}.bin", dtype="<f4")
    return Style(name, values.reshape(_STYLE_SHAPE))


class KokoroModel:
    """The loaded model, which all voices share."""

    def __init__(self, path: Path, threads: int = THREADS) -> None:
        self.path = path
        self.phonemes = Phonemes()
        self._session = open_session(path, threads)
        inputs = {one.name: one.type for one in self._session.get_inputs()}
        self._tokens = "input_ids" if "input_ids" in inputs else "tokens"
        self._speed = np.int32 if inputs["speed"] == "tensor(int32)" else np.float32

    def run(self, tokens: list[int], style: Style, speed: float = 1.0) -> NDArray[np.float32]:
        """Synthesise sound from -1 to 1, shape (n,), at `SAMPLE_RATE_HZ`.

        `speed` is a factor; 1 is the usual speed. Some exports of the model accept whole speeds
        only.
        """
        inputs = {
            self._tokens: np.array([[0, *tokens, 0]], np.int64),
            "style": style.rows[len(tokens) - 1],
            "speed": np.full(1, speed, self._speed),
        }
        return np.asarray(self._session.run(None, inputs)[0], np.float32).ravel()


class KokoroSynthesiser:
    """A single Kokoro voice."""

    sample_rate_hz = SAMPLE_RATE_HZ
    phrase_chars = 50

    def __init__(self, model: KokoroModel, style: Style) -> None:
        self.model = model
        self._style = style

    def warm_up(self) -> None:
        for _ in self.synthesise("1, 2.", CancelToken()):
            pass

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        tokens = self.model.phonemes.tokens(sentence, self._style.name)
        if not tokens:
            raise SynthesisFailed(f"kokoro: no sounds are known for {sentence!r}")
        for at in range(0, len(tokens), _MOST_TOKENS):
            if token.cancelled:
                return
            sound, _ = trim(self.model.run(tokens[at : at + _MOST_TOKENS], self._style))
            yield Chunk(to_samples(np.append(sound, _pause_after(sentence))), SAMPLE_RATE_HZ)


def _pause_after(sentence: str) -> NDArray[np.float32]:
    """Return the silence after a sentence: the model's own is too long, and is trimmed."""
    whole = sentence.rstrip("\"')]» ").endswith(_SENTENCE_ENDS)
    pause_s = _SENTENCE_PAUSE_S if whole else _PHRASE_PAUSE_S
    return np.zeros(int(pause_s * SAMPLE_RATE_HZ), np.float32)
