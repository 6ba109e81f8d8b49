"""What Kokoro reads: phonemes, as tokens of its vocabulary."""

import logging
import re
import unicodedata
from importlib import import_module
from typing import Any

from kokoro_onnx.tokenizer import Tokenizer
from phonemizer import phonemize  # type: ignore[import-untyped]

from edgevox.voice.tts.kana import kana

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
"""How Kokoro learnt to write what espeak-ng writes otherwise."""
_SWITCH = re.compile(r"\([a-z]{2,3}(?:-[a-z]+)?\)")
"""What espeak-ng puts around a foreign word: ``(en)`` before and ``(fr)`` after it."""


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
        """By espeak-ng, without the marks that Kokoro has no tokens for."""
        read = phonemize(
            kana(text), "ja", backend="espeak", preserve_punctuation=True, with_stress=True
        )
        letters = unicodedata.normalize("NFD", str(read)).translate(_JAPANESE)
        phonemes = unicodedata.normalize("NFC", letters)
        for doubled, learnt in _DOUBLED.items():
            phonemes = phonemes.replace(doubled, learnt)
        return phonemes
