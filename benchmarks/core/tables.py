"""Figures as Markdown: numbers, cells, and the tables of one benchmark."""

import ast
from collections.abc import Callable, Iterable, Sequence

from benchmarks import ROOT
from benchmarks.core.environment import Environment
from benchmarks.core.figures import Figure
from benchmarks.core.listed import BENCHMARKS
from benchmarks.core.results import Results, Run

Cell = Callable[[Figure, Run], str]


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; all but the first column stand to the right."""
    rule = ("---", *("---:" for _ in heads[1:]))
    return "".join(f"| {' | '.join(row)} |\n" for row in (heads, rule, *rows))


def number(value: float) -> str:
    """Three digits that say something, and none that does not."""
    if value == 0 or (value.is_integer() and abs(value) < 10_000):
        return f"{value:,.0f}"
    size = abs(value)
    decimals = 0 if size >= 100 else 1 if size >= 10 else 2 if size >= 0.1 else 3
    return f"{value:,.{decimals}f}"


def quantity(value: float, figure: Figure) -> str:
    """A number with the figure's unit."""
    unit = figure.unit
    return f"{number(value)}{_joint(unit)}{unit}"


def measured(figure: Figure, _: Run | None = None) -> str:
    """The figure itself."""
    if figure.unit == "right":
        return f"{number(figure.value)} of {figure.n}"
    return quantity(figure.value, figure)


def spread(figure: Figure, _: Run | None = None) -> str:
    """From the least to the most."""
    if figure.least is None or figure.most is None:
        return ""
    return f"{number(figure.least)} to {number(figure.most)}"


def interval(figure: Figure, _: Run | None = None) -> str:
    """Between what a share lies."""
    if figure.low is None or figure.high is None:
        return ""
    return f"{number(figure.low)} to {number(figure.high)} {figure.unit}"


def largest(figure: Figure, _: Run | None = None) -> str:
    """The most of all samples."""
    return "" if figure.most is None else quantity(figure.most, figure)


def wanted(figure: Figure, _: Run | None = None) -> str:
    """The target; in bold where it was missed."""
    if figure.wanted is None:
        return ""
    text = quantity(figure.wanted, figure)
    return f"**{text}**" if figure.missed else text


def beside(figure: Figure, run: Run) -> str:
    """The plain library's figure."""
    return measured(run.figure(figure.baseline)) if figure.baseline else ""


def ratio(figure: Figure, run: Run) -> str:
    """Ours against the plain library's."""
    found = run.ratio(figure)
    return "" if found is None else number(found)


COLUMNS: tuple[tuple[str, Cell], ...] = (
    ("median", measured),
    ("least to most", spread),
    ("95 % interval", interval),
    ("of", lambda figure, _: str(figure.n) if figure.n > 1 else ""),
    ("wanted", wanted),
    ("plain", beside),
    ("ratio", ratio),
)


def of_benchmark(name: str, results: Results) -> str:
    """All that a benchmark found: how, when, its tables, its notes."""
    run = results.run(name)
    parts = [docstring(name), "", when(run), ""]
    titles = list(dict.fromkeys(figure.table for figure in run.figures))
    for title in titles:
        chosen = [figure for figure in run.figures if figure.table == title]
        parts += [f"### {title}", "", _crossed(chosen, run) or _listed(chosen, run)]
    for heading, lines in run.notes.items():
        parts += [f"{heading}:", ""]
        parts += [f"- {line}" for line in lines] + [""]
    return "\n".join(parts).rstrip() + "\n"


def when(run: Run) -> str:
    """When, at which commit, how long, on how busy a machine."""
    quick = " **Too few rounds to be quoted.**" if run.quick else ""
    return (
        f"Measured on {run.measured:%d %B %Y} at {at_commit(run)}, in {run.took_s:,.0f} s; the "
        f"machine's load before was {run.load_before:.2f}.{quick}"
    )


def at_commit(run: Run) -> str:
    """The commit, and whether it was changed."""
    if not run.commit:
        return "no commit"
    return f"commit `{run.commit}`" + (" with changes" if run.changed else "")


def described(environments: Iterable[Environment]) -> str:
    """The machines and the versions."""
    parts = []
    for one in environments:
        versions = ", ".join(f"{name} {version}" for name, version in one.versions.items())
        parts.append(f"{one.machine}. With {versions}.\n")
    return "\n".join(parts)


def docstring(name: str) -> str:
    """What a benchmark says of itself."""
    file = ROOT / f"{BENCHMARKS[name].module.replace('.', '/')}.py"
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return ast.get_docstring(tree) or ""


def _listed(figures: Sequence[Figure], run: Run) -> str:
    """A row a figure; columns that say nothing are left out."""
    cells = {head: [cell(one, run) for one in figures] for head, cell in COLUMNS}
    heads = [head for head, column in cells.items() if any(column)]
    rows = zip((one.what for one in figures), *(cells[head] for head in heads), strict=True)
    return table(("what", *heads), rows)


def _crossed(figures: Sequence[Figure], run: Run) -> str:
    """Rows against columns; empty where the figures have no columns."""
    columns = list(dict.fromkeys(one.column for one in figures))
    if columns == [""]:
        return ""
    rows = []
    for what in dict.fromkeys(one.what for one in figures):
        found = {one.column: one for one in figures if one.what == what}
        rows.append((what, *(_crossing(found.get(column), run) for column in columns)))
    return table(("what", *columns), rows)


def _crossing(figure: Figure | None, run: Run) -> str:
    if figure is None:
        return ""
    against = ratio(figure, run)
    beside = [f"{against} times"] if against else []
    beside += [between] if (between := interval(figure, run)) else []
    beside += [f"wanted {wanted(figure)}"] if figure.missed else []
    return measured(figure) + (f" ({', '.join(beside)})" if beside else "")


def _joint(unit: str) -> str:
    return "" if unit in ("", "x") else " "
