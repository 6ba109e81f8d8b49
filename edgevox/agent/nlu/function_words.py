"""The small words of a language that say how a sentence is meant: see `function_words.toml`."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from typing import Any

_FILE = "function_words.toml"


@dataclass(frozen=True, slots=True)
class FunctionWords:
    """What is said around a command, in one language.

    `fillers` mean nothing to a robot. `urges` are said to whoever should do something, where
    nothing else says so: "kitchen, quickly". `negations` deny what follows. `corrections` take back
    what came before. `reports` tell what somebody said or needs, `conditions` what was, will be or
    might be, and `doubts` speak of others than the robot; `questions` open one. `asking` opens an
    order that is put politely, so that it is one although it looks like a question. `wishes` open
    one that is put as a statement: "you' re needed". `reasons` open a clause that only says why.
    `reversals` say that the order of doing is not that of saying. `plans` are what the speaker or
    others do themselves, `pronouns` stand for a thing. `linking` stand between an axis and its
    number, `gerunds` before a verb that stands for its order: "interpreter going". `misheard` are
    words as a recogniser of speech writes them down, with those that were said.
    """

    fillers: tuple[str, ...] = ()
    urges: tuple[str, ...] = ()
    negations: tuple[str, ...] = ()
    corrections: tuple[str, ...] = ()
    reports: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    asking: tuple[str, ...] = ()
    wishes: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    reversals: tuple[str, ...] = ()
    plans: tuple[str, ...] = ()
    pronouns: tuple[str, ...] = ()
    linking: tuple[str, ...] = ()
    gerunds: tuple[str, ...] = ()
    misheard: Mapping[str, str] = field(default_factory=dict)

    def all(self) -> tuple[str, ...]:
        """Every one of them."""
        return (
            *self.fillers, *self.urges, *self.negations, *self.corrections, *self.reports,
            *self.conditions, *self.doubts, *self.questions, *self.asking, *self.wishes,
            *self.reasons, *self.reversals,
        )  # fmt: skip


def words_of(code: str) -> FunctionWords:
    """Those of a language of the catalogue."""
    return _read()[code]


@lru_cache(maxsize=1)
def _read() -> Mapping[str, FunctionWords]:
    text = files(__package__).joinpath(_FILE).read_text(encoding="utf-8")
    tables: dict[str, dict[str, Any]] = tomllib.loads(text)
    return {
        code: FunctionWords(
            misheard=table.get("misheard", {}),
            **{n: tuple(words) for n, words in table.items() if n != "misheard"},
        )
        for code, table in tables.items()
    }
