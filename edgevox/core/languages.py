"""The catalogue of languages, one file each in the folder `languages` beside this file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from edgevox.core.language_files import ByLanguage, language_file
from edgevox.core.stop_words import STOP_WORDS, StopWords

STT_BACKEND = "faster-whisper"
KOKORO_MODELS = ("kokoro-82m", "kokoro-voices")
"""The ids in edgevox-models of Kokoro's model and of all its voices."""


@dataclass(frozen=True, slots=True)
class Voice:
    """A text-to-speech voice of a language.

    `backend` is piper, kokoro or espeak, `key` what that backend calls the voice (espeak-ng: the
    language). `models` are the ids in edgevox-models of what it needs.
    """

    name: str
    backend: str
    key: str
    models: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Language:
    """One language: its ISO 639-1 code, its English name, its voices, the words that stop a robot.

    `spaced` is False for scripts that write words without spaces between them. `stt_model` is the
    id in edgevox-models of what hears it. `voices` are best first; the last is espeak-ng's, which
    needs no model. `signs` are the words for signs that a voice would swallow, such as a minus.
    """

    code: str
    name: str
    stop: StopWords
    signs: Mapping[str, str]
    spaced: bool = True
    stt_model: str = ""
    voices: tuple[Voice, ...] = ()


def _voices(code: str, entry: Mapping[str, Any]) -> Iterator[Voice]:
    """The voices of one table, in its order of backends; an alias comes after what it names."""
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
