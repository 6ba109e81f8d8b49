"""The catalogue of languages: `languages/CODE.toml` beside this file holds all data of a language.

A file is read when it is first needed: reading all takes longer than most programs need to start.
`every_language.toml` holds data that belongs to no single language.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from edgevox.core.errors import EdgeVoxError, InvalidValue

_HERE = resources.files("edgevox.core")
_FOLDER = _HERE / "languages"
_ENDING = ".toml"
_TABLE = re.compile(r"^\[", re.MULTILINE)
"""The beginning of the next table."""
_NEEDED = ("name", "signs", "stt", "tts", "espeak", "stop")
"""Keys that every language needs. Other keys fall back to English, or are left out."""

EVERY_LANGUAGE: Mapping[str, Any] = MappingProxyType(
    tomllib.loads((_HERE / "every_language.toml").read_text("utf-8"))
)
"""Data that belongs to no single language."""

_Kept = TypeVar("_Kept")


class UnusableLanguage(EdgeVoxError):
    """The file of a language cannot be used; the message has its path and the reason."""

    def __init__(self, code: str, why: str) -> None:
        super().__init__(f"{_FOLDER / code}{_ENDING}: {why}")


def _codes() -> tuple[str, ...]:
    """Codes of the languages that have a file, those of `order` first."""
    names = (file.name for file in _FOLDER.iterdir())
    found = {name.removesuffix(_ENDING) for name in names if name.endswith(_ENDING)}
    order = [code for code in EVERY_LANGUAGE["order"] if code in found]
    return (*order, *sorted(found.difference(order)))


CODES: tuple[str, ...] = _codes()
"""ISO 639-1 codes of all languages, in the order of lists; English is first."""


@cache
def language_file(code: str) -> Mapping[str, Any]:
    """The contents of a language's file.

    Raises `InvalidValue` for an unknown code, and `UnusableLanguage` for a file that is no TOML or
    lacks a needed key.
    """
    if code not in CODES:
        raise InvalidValue("language", code, "one of " + ", ".join(CODES))
    try:
        tables = tomllib.loads((_FOLDER / f"{code}{_ENDING}").read_text("utf-8"))
    except ValueError as error:
        raise UnusableLanguage(code, str(error)) from error
    for one in _NEEDED:
        if one not in tables:
            raise UnusableLanguage(code, f"it has no {one!r}, which en{_ENDING} explains")
    return MappingProxyType(tables)


@cache
def language_table(code: str, name: str) -> Mapping[str, Any]:
    """One table of a language's file, parsed alone if possible. Raises as `language_file`.

    Some tables, such as the stop words, are needed of all languages at once.
    """
    header = f"\n[{name}]\n"
    text = (_FOLDER / f"{code}{_ENDING}").read_text("utf-8") if code in CODES else ""
    begin = text.find(header)
    if begin >= 0:
        end = _TABLE.search(text, begin + len(header))
        with suppress(ValueError):  # parsing the whole file below reports the error
            found = tomllib.loads(text[begin : end.start() if end else len(text)])
            return MappingProxyType(found[name])
    table: Mapping[str, Any] = language_file(code)[name]
    return table


class ByLanguage(Mapping[str, _Kept], Generic[_Kept]):
    """A mapping from each language code to a value that is made at its first use."""

    def __init__(self, make: Callable[[str], _Kept]) -> None:
        self._make = make
        self._made: dict[str, _Kept] = {}

    def __getitem__(self, code: str) -> _Kept:
        if code not in self._made:
            if code not in CODES:
                raise KeyError(code)
            self._made[code] = self._make(code)
        return self._made[code]

    def __contains__(self, code: object) -> bool:
        return code in CODES

    def __iter__(self) -> Iterator[str]:
        return iter(CODES)

    def __len__(self) -> int:
        return len(CODES)


@dataclass(frozen=True, slots=True)
class StopWords:
    """The stop words of one language; `languages/en.toml` explains each field."""

    anywhere: tuple[str, ...]
    last: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()
    courtesies: tuple[str, ...] = ()
    innocent: tuple[str, ...] = ()
    denials: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    ordinary: tuple[str, ...] = ()
    hesitant: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()

    @property
    def all(self) -> tuple[str, ...]:
        """Every word that can stop a robot, whatever its place in a sentence must be."""
        return self.anywhere + self.last + self.alone


def _words(code: str) -> StopWords:
    table = language_table(code, "stop")
    known = {one.name for one in fields(StopWords)}
    if "anywhere" not in table or not table.keys() <= known:
        raise UnusableLanguage(code, f"[stop] has anywhere, and at most {', '.join(sorted(known))}")
    return StopWords(**{field: tuple(words) for field, words in table.items()})


STOP_SIGNS: tuple[str, ...] = tuple(EVERY_LANGUAGE["stop_signs"])
"""Pictures that stop a robot in every language."""

STOP_WORDS: Mapping[str, StopWords] = ByLanguage(_words)
"""Stop words by ISO 639-1 code."""


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


def language_code(tag: str) -> str:
    """The code of a language's tag or locale, such as de-DE or pt_BR.UTF-8. Raises `ValueError`."""
    code = re.split(r"[-_.@]", tag.strip(), maxsplit=1)[0].lower()
    if code not in LANGUAGES:
        raise ValueError("one of " + ", ".join(LANGUAGES))
    return code
