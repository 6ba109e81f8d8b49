"""How fast every body's world is, and what EdgeVox adds to its simulator.

Each body and its simulator alone run in the same run, in CPU time.
"""

import re
from collections.abc import Iterator

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.robots import diff_drive as robots_diff_drive
from benchmarks.robots import humanoid as robots_humanoid
from benchmarks.robots import panda as robots_panda
from benchmarks.robots.worlds import Row
from edgevox.models import ModelMissing

TABLE = "How fast the bodies are"
ROUNDS = 5
_NOT_WORDS = re.compile(r"[^a-z0-9]+")


def measure(quick: bool = False) -> Measured:
    """All bodies, one after the other."""
    rounds = 1 if quick else ROUNDS
    try:
        rows = [
            *robots_diff_drive.measure(rounds),
            *robots_panda.measure(rounds),
            *robots_humanoid.measure(rounds),
        ]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figure for row in rows for figure in figures(row)))


def figures(row: Row) -> Iterator[Figure]:
    """What is told of one body that does one thing."""
    name = _NOT_WORDS.sub("_", f"{row.body.removeprefix('robot-')} {row.what}".lower())
    what = f"{row.body}: {row.what}"

    def one(part: str, column: str, value: float, unit: str, **more: object) -> Figure:
        return Figure.of(
            f"{name}.{part}" if part else name, TABLE, what, [value], unit, column=column, **more
        )

    beside = f"{name}.alone" if row.alone else ""
    yield one("", "x real time", row.factor, "x", more_is_better=True, baseline=beside)
    if row.alone is not None:
        yield one("alone", "simulator alone", row.alone, "x", more_is_better=True)
    if row.added is not None:
        yield one("added", "the layer adds", 100 * row.added, "%")
    if row.added_s is not None:
        yield one("step", "the layer adds to a step", 1e6 * row.added_s, "µs")
    if row.added_by_all is not None:
        yield one("added_by_all", "all adds", 100 * row.added_by_all, "%")
