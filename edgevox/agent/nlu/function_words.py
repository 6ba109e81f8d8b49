"""The small words that say how a sentence is meant: `[function_words]` of a language's file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from edgevox.core.language_files import language_file


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
    number, `gerunds` before a verb that stands for its order: "interpreter going". `copulas` stand
    beside a name of which something is told: "the kitchen' s over there". `misheard` are words as a
    recogniser of speech writes them down, with those that were said.

    `abilities` may ask what somebody can do, and not for it. `amounts` are parts of numbers, units
    and times: one that no value took leaves no order.
    `number_marks` are so only beside a number: "two point five". So are `bounds`: "at least two".
    `put_off` say that an order is not for now; one that ends in " ." must end the sentence, and one
    that begins with ". " begin it.
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
    copulas: tuple[str, ...] = ()
    abilities: tuple[str, ...] = ()
    amounts: tuple[str, ...] = ()
    number_marks: tuple[str, ...] = ()
    bounds: tuple[str, ...] = ()
    put_off: tuple[str, ...] = ()
    misheard: Mapping[str, str] = field(default_factory=dict)

    def all(self) -> tuple[str, ...]:
        """Every one of them."""
        return (
            *self.fillers, *self.urges, *self.negations, *self.corrections, *self.reports,
            *self.conditions, *self.doubts, *self.questions, *self.asking, *self.wishes,
            *self.reasons, *self.reversals, *self.amounts, *self.number_marks, *self.bounds,
            *self.put_off,
        )  # fmt: skip


@cache
def words_of(code: str) -> FunctionWords:
    """Those of a language of the catalogue; none if its file has none."""
    table: Mapping[str, Any] = language_file(code).get("function_words", {})
    return FunctionWords(
        misheard=table.get("misheard", {}),
        **{n: tuple(words) for n, words in table.items() if n != "misheard"},
    )
