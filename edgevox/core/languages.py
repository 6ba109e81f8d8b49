"""The catalogue of languages, read from `languages.toml` beside this file."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Language:
    """One language: its ISO 639-1 code, its English name, its voices, the words that stop a robot.

    `stop_alone` are words that stop it only when nothing else is said. `spaced` is False for
    scripts that write words without spaces between them. `negations` are the words before a stop
    word that turn it around ("don't stop").
    """

    code: str
    name: str
    stop_words: tuple[str, ...]
    stop_alone: tuple[str, ...] = ()
    negations: tuple[str, ...] = ()
    spaced: bool = True
    voices: tuple[str, ...] = ()


def _read() -> Mapping[str, Language]:
    text = resources.files("edgevox.core").joinpath("languages.toml").read_text("utf-8")
    return MappingProxyType(
        {
            code: Language(
                code=code,
                name=entry["name"],
                stop_words=tuple(entry["stop_words"]),
                stop_alone=tuple(entry.get("stop_alone", ())),
                negations=tuple(entry.get("negations", ())),
                spaced=entry.get("spaced", True),
                voices=tuple(entry.get("voices", ())),
            )
            for code, entry in tomllib.loads(text).items()
        }
    )


LANGUAGES: Mapping[str, Language] = _read()
"""Language by ISO 639-1 code."""
