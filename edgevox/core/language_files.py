"""The files of languages: `languages/CODE.toml` beside this file is all that is known of one.

Each is read when something first asks for it: reading all of them takes longer than most programs
need to start. `every_language.toml` holds what is of no single language.
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
"""Where the next table begins."""
_NEEDED = ("name", "signs", "stt", "tts", "espeak", "stop")
"""What a robot cannot be spoken to without. All else has an answer in English, or is left out."""

EVERY_LANGUAGE: Mapping[str, Any] = MappingProxyType(
    tomllib.loads((_HERE / "every_language.toml").read_text("utf-8"))
)
"""What is of no single language."""

_Kept = TypeVar("_Kept")


class UnusableLanguage(EdgeVoxError):
    """The file of a language cannot be used; the message names it, and says why."""

    def __init__(self, code: str, why: str) -> None:
        super().__init__(f"{_FOLDER / code}{_ENDING}: {why}")


def _codes() -> tuple[str, ...]:
    """The languages that there is a file of, those of `order` first."""
    names = (file.name for file in _FOLDER.iterdir())
    found = {name.removesuffix(_ENDING) for name in names if name.endswith(_ENDING)}
    order = [code for code in EVERY_LANGUAGE["order"] if code in found]
    return (*order, *sorted(found.difference(order)))


CODES: tuple[str, ...] = _codes()
"""The ISO 639-1 codes of all languages, in the order in which they are listed; English first."""


@cache
def language_file(code: str) -> Mapping[str, Any]:
    """All that the file of a language holds.

    Raises `InvalidValue` for one that there is none of, and `UnusableLanguage` for one that is no
    TOML, or lacks what each needs.
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
    """One table of a file, without reading the rest where it stands by itself; raises likewise.

    Some tables are wanted of all languages, such as what stops a robot, and at once.
    """
    header = f"\n[{name}]\n"
    text = (_FOLDER / f"{code}{_ENDING}").read_text("utf-8") if code in CODES else ""
    begin = text.find(header)
    if begin >= 0:
        end = _TABLE.search(text, begin + len(header))
        with suppress(ValueError):  # the whole file says what is wrong
            found = tomllib.loads(text[begin : end.start() if end else len(text)])
            return MappingProxyType(found[name])
    table: Mapping[str, Any] = language_file(code)[name]
    return table


class ByLanguage(Mapping[str, _Kept], Generic[_Kept]):
    """Something of each language, made of its file when first asked for."""

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
