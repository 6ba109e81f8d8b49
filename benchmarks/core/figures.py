"""What a benchmark finds: figures, each with its unit, and where there is one with a target and a
plain library's own figure beside it.

A benchmark is a module with ``measure(quick: bool) -> Measured``. Where what it needs is not on
this machine it raises `NotHere`.
"""

import math
import statistics
import sys
from collections.abc import Callable, Sequence
from typing import Self

from pydantic import BaseModel, ConfigDict, Field

_Z95 = 1.959964


class NotHere(Exception):
    """What a benchmark needs is not on this machine; the message says what."""


class Kept(BaseModel):
    """Something that is kept in the file of results."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Figure(Kept):
    """One figure. It stands in the row `what` of its `table`, in a `column` if there are several.

    `value` is the median where there are several samples, `n` of them from `least` to `most`.
    `wanted` is the most that is wanted of it, or the least where `more_is_better`. `baseline` is
    the id of the figure, in the same benchmark, that a plain library reached on the same work.
    `low` and `high` are between what a share lies with 95 % confidence, were its tries apart.
    """

    id: str = Field(pattern=r"^[a-z0-9_.-]+$")
    table: str
    what: str
    column: str = ""
    unit: str = ""
    value: float
    least: float | None = None
    most: float | None = None
    low: float | None = None
    high: float | None = None
    n: int = Field(1, ge=1)
    wanted: float | None = None
    more_is_better: bool = False
    baseline: str = ""

    @classmethod
    def of(
        cls,
        id: str,  # noqa: A002
        table: str,
        what: str,
        samples: Sequence[float],
        unit: str = "",
        **more: object,
    ) -> Self:
        """The figure that these samples make."""
        return cls.model_validate(
            {
                "id": id,
                "table": table,
                "what": what,
                "unit": unit,
                "value": _rounded(statistics.median(samples)),
                "least": _rounded(min(samples)) if len(samples) > 1 else None,
                "most": _rounded(max(samples)) if len(samples) > 1 else None,
                "n": len(samples),
                **more,
            }
        )

    @classmethod
    def share(cls, id: str, table: str, what: str, hits: int, tries: int, **more: object) -> Self:  # noqa: A002
        """How many of a hundred tries were hits, and how sure that is."""
        low, high = wilson(hits, tries)
        value = 100 * hits / tries
        return cls.model_validate(
            {
                "id": id,
                "table": table,
                "what": what,
                "unit": "%",
                "value": _rounded(value),
                "low": _rounded(100 * low),
                "high": _rounded(100 * high),
                "n": tries,
                **more,
            }
        )

    @property
    def missed(self) -> bool:
        """Whether it is worse than what was wanted."""
        if self.wanted is None:
            return False
        return self.value < self.wanted if self.more_is_better else self.value > self.wanted


class Measured(Kept):
    """All that one benchmark found; `notes` are lines worth reading, by heading."""

    figures: tuple[Figure, ...] = Field(min_length=1)
    notes: dict[str, tuple[str, ...]] = Field(default_factory=dict)


def printed(name: str, measure: Callable[[], Measured]) -> int:
    """Print what a benchmark finds, its notes first: 0; or why it is not measured here: 2."""
    try:
        found = measure()
    except NotHere as reason:
        print(f"{name}: not measured: {reason}", file=sys.stderr)
        return 2
    for heading, lines in found.notes.items():
        print(f"{heading}:", *lines, "", sep="\n")
    for one in found.figures:
        print(f"{one.table}: {one.what}, {one.column}: {one.value} {one.unit} of {one.n}")
    return 0


def wilson(hits: int, tries: int) -> tuple[float, float]:
    """Between what a share lies with 95 % confidence, by Wilson; also where none or all were hits.

    It takes the tries for independent, which words of one voice are not quite.
    """
    share, z = hits / tries, _Z95
    middle = share + z**2 / (2 * tries)
    beside = z * math.sqrt(share * (1 - share) / tries + z**2 / (4 * tries**2))
    whole = 1 + z**2 / tries
    return max(0.0, (middle - beside) / whole), min(1.0, (middle + beside) / whole)


def _rounded(value: float) -> float:
    """Five significant digits: more would be noise, in every line of a comparison."""
    return float(f"{value:.5g}")
