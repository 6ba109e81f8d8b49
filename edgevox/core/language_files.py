"""The files of languages: `languages/CODE.toml` beside this file holds all data of a language.

A file is read when it is first needed: reading all takes longer than most programs need to start.
`every_language.toml` holds data that belongs to no single language.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
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
