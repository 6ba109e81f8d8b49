"""The table of what stops a robot, read from `stop_words.toml` beside this file."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True, slots=True)
class StopWords:
    """What stops a robot in one language; the head of `stop_words.toml` says what each field is."""

    anywhere: tuple[str, ...]
    last: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()
    courtesies: tuple[str, ...] = ()
    innocent: tuple[str, ...] = ()
    others: tuple[str, ...] = ()

    @property
    def all(self) -> tuple[str, ...]:
        """Every word that can stop a robot, wherever it has to stand."""
        return self.anywhere + self.last + self.alone


def _read() -> dict[str, Any]:
    text = resources.files("edgevox.core").joinpath("stop_words.toml").read_text("utf-8")
    return tomllib.loads(text)


_TABLE = _read()

STOP_SIGNS: tuple[str, ...] = tuple(_TABLE.pop("signs"))
"""Pictures that stop a robot in every language."""

STOP_WORDS: Mapping[str, StopWords] = MappingProxyType(
    {
        code: StopWords(**{field: tuple(words) for field, words in entry.items()})
        for code, entry in _TABLE.items()
    }
)
"""Stop words by ISO 639-1 code."""
