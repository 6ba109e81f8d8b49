"""What is said in languages other than English: stop words, and what sounds like them."""

import functools
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from edgevox.agent.stop.words import find_stop_word
from edgevox.voice.tts.espeak import kana
from training.acoustics import Half
from training.acoustics.voices import espeak_speakers, kokoro_voices

FILE = Path(__file__).with_name("languages.toml")
_ESPEAK_ACCENTS = {
    "es": ("es", "es-419"),
    "fr": ("fr-fr", "fr-be", "fr-ch"),
    "pt": ("pt", "pt-br"),
    "zh": ("cmn",),
}
"""What espeak-ng calls a language, where it has another name or several."""


_UNSPACED = ("ja", "zh")
"""Where nothing is between words."""


@dataclass(frozen=True, slots=True)
class Texts:
    """Those of one part in one language: `ends` end with the stop word by which they are kept,
    `within` go on after it; `alike` and `talk` hold none.
    """

    ends: Mapping[str, Sequence[str]]
    within: Mapping[str, Sequence[str]] = field(default_factory=dict)
    alike: Sequence[str] = ()
    talk: Sequence[str] = ()


@functools.cache
def _file() -> Mapping[str, Mapping[str, Mapping[str, Mapping[str, Sequence[str]]]]]:
    return tomllib.loads(FILE.read_text("utf-8"))


def languages() -> tuple[str, ...]:
    """Their ISO 639-1 codes."""
    return tuple(_file())


def texts(language: str, half: Half) -> Texts:
    """What is said in it, of this part."""
    return Texts(**_file()[language][half.name.casefold()])


def words(language: str) -> tuple[str, ...]:
    """The stop words that are known in it by their sound."""
    return tuple(texts(language, Half.TRAIN).ends)


def has_none(text: str, language: str) -> bool:
    """Whether neither the text nor how it is read has a stop word of the language, or of English,
    in it: "it has stopped" may sound like one that is said.
    """
    if find_stop_word(language, text):  # English ones are among them
        return False
    if language in _UNSPACED:
        said = text + read_aloud(text, language).replace(" ", "")
        known = {form for word in words(language) for form in (word, read_aloud(word, language))}
        return not any(word in said for word in known)
    known = "|".join(re.escape(word) for word in words(language))
    return not re.search(rf"(?<!\w)(?:{known})(?!\w)", text, re.IGNORECASE)


def kokoro_speakers(language: str, half: Half) -> tuple[str, ...]:
    """Kokoro's voices of this part, who read it aloud as they can; names for `say`."""
    return tuple(f"{voice}@{language}" for voice in kokoro_voices(half))


def espeak_speakers_of(language: str, half: Half) -> tuple[str, ...]:
    """espeak-ng's speakers of this part in all accents of the language; names for `say`."""
    accents = _ESPEAK_ACCENTS.get(language, (language,))
    return tuple(f"espeak:{accent}+{who}" for who in espeak_speakers(half) for accent in accents)


def is_native(voice: str, language: str) -> bool:
    """Whether it is the language of this voice of Kokoro's, by the first letter of its name."""
    return voice.startswith(f"kokoro:{language[0]}")


def read_aloud(text: str, language: str) -> str:
    """The text as espeak-ng is to be told it: it reads no Chinese letters in Japanese."""
    return kana(text) if language == "ja" else text
