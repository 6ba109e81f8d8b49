"""Stop words: the table `[stop]` of each language's file."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

from edgevox.core.language_files import (
    EVERY_LANGUAGE,
    ByLanguage,
    UnusableLanguage,
    language_table,
)


@dataclass(frozen=True, slots=True)
class StopWords:
    """The stop words of one language; `languages/en.toml` explains each field."""

    anywhere: tuple[str, ...]
    last: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()
    courtesies: tuple[str, ...] = ()
    innocent: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    ordinary: tuple[str, ...] = ()

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
