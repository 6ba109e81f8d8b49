"""The catalogue of languages, one file each in the folder `languages` beside this file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from edgevox.core.language_files import ByLanguage, language_file
from edgevox.core.stop_words import STOP_WORDS, StopWords

STT_BACKEND = "faster-whisper"
KOKORO_MODELS = ("kokoro-82m", "kokoro-voices")
"""Ids in edgevox-models of Kokoro's model and of all its voices."""


@dataclass(frozen=True, slots=True)
class Voice:
    """A text-to-speech voice of a language."""

    name: str
    """The name in settings."""
    backend: str
    """`piper`, `kokoro` or `espeak`."""
    key: str
    """The backend's name for the voice; for espeak-ng that of the language."""
    models: tuple[str, ...] = ()
    """Ids in edgevox-models of the models that it needs."""


@dataclass(frozen=True, slots=True)
class Language:
    """A language of the catalogue."""

    code: str
    """ISO 639-1 code."""
    name: str
    """English name."""
    stop: StopWords
    """Words that stop a robot."""
    signs: Mapping[str, str]
    """Words for signs that a voice would swallow, such as a minus."""
    spaced: bool = True
    """False for a script without spaces between words."""
    stt_model: str = ""
    """Id in edgevox-models of the speech recognition model."""
    voices: tuple[Voice, ...] = ()
    """Voices, the best first; the last is espeak-ng's, which needs no model."""


def _voices(code: str, entry: Mapping[str, Any]) -> Iterator[Voice]:
    """The voices of one table, in its order of backends; an alias follows its voice."""
    aliases = {key: name for name, key in entry.get("aliases", {}).items()}
    for backend in entry["tts"]:
        if backend == "espeak":
            yield Voice(f"espeak-{code}", backend, entry["espeak"])
            continue
        for key in entry[backend]:
            models = KOKORO_MODELS if backend == "kokoro" else (f"{backend}-{key}",)
            yield Voice(key, backend, key, models)
            if key in aliases:
                yield Voice(aliases[key], backend, key, models)


def _language(code: str) -> Language:
    entry = language_file(code)
    return Language(
        code=code,
        name=entry["name"],
        stop=STOP_WORDS[code],
        signs=MappingProxyType(entry["signs"]),
        spaced=entry.get("spaced", True),
        stt_model=entry["stt"],
        voices=tuple(_voices(code, entry)),
    )


LANGUAGES: Mapping[str, Language] = ByLanguage(_language)
"""Language by ISO 639-1 code."""
