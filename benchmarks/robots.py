"""How fast every body's world is, and what our layer adds to its simulator.

    python benchmarks/robots.py

Every body and its simulator alone are measured in the same run, in time of the processor: several
threads and other programs share a machine. Writes a table in Markdown.
"""

from collections.abc import Sequence
from pathlib import Path

import robots_humanoid
import robots_panda
import robots_planar
from machine import machine
from worlds import Row

FILE = Path(__file__).with_suffix(".md")
HEAD = """# How fast the bodies are

Written by `benchmarks/robots.py`. Figures are seconds of the world for one second of the
processor, all threads together, and so is the simulator alone: the same model in the same steps,
under the same commands, in the same run. "The layer adds" is what the thread that steps the world
spends beside the simulator (locks, control, watching over the physics), as a part of the
simulator's own time; "all adds" counts everything else too: the arm's motions that are planned, the
walking policy's inference, ways through the apartment. A camera's pictures are drawn by the
processor here.
"""


def table(rows: Sequence[Row]) -> str:
    """The figures as a Markdown table."""
    lines = [
        f"Measured on {machine()}.",
        "",
        "| body | what | x real time | simulator alone | the layer adds | all adds |",
        "|---|---|---:|---:|---:|---:|",
    ]
    for row in rows:
        alone = f"{row.alone:,.0f}" if row.alone else ""
        added, by_all = _percent(row.added), _percent(row.added_by_all)
        cells = (row.body, row.what, f"{row.factor:,.0f}", alone, added, by_all)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.1f} %"


def main() -> None:
    """Measure, write the table, print it."""
    rows = [*robots_planar.measure(), *robots_panda.measure(), *robots_humanoid.measure()]
    text = table(rows)
    FILE.write_text(f"{HEAD}\n{text}", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
