"""Figures as Markdown: numbers, cells, and the tables of one benchmark."""

import ast
from collections.abc import Callable, Iterable, Mapping, Sequence

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
    """All figures that a benchmark found, how and when; of its notes only how many there are."""
    run = results.run(name)
    parts = [docstring(name).replace("\n\n", "\n", 1), when(run), "", *_tables(run)]
    if notes := "; ".join(f"{head} ({len(lines)})" for head, lines in run.notes.items() if lines):
        parts.append(f"`benchmarks/results.json` has notes: {notes}.")
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
    """The machines, and the versions on them; each block names its commit of EdgeVox."""
    there = list(environments)
    machines = list(dict.fromkeys(str(one.machine) for one in there))
    found: dict[str, list[str]] = {}
    for one in there:
        for name in one.versions.keys() - {"edgevox"}:
            found.setdefault(name, []).append(one.versions[name])
    versions = ", ".join(
        f"{name} {' or '.join(sorted(set(known)))}" for name, known in sorted(found.items())
    )
    return f"With {versions}, on:\n\n" + "".join(f"- {one}\n" for one in machines)


def docstring(name: str) -> str:
    """What a benchmark says of itself."""
    file = ROOT / f"{BENCHMARKS[name].module.replace('.', '/')}.py"
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return ast.get_docstring(tree) or ""


def _tables(run: Run) -> list[str]:
    """Its tables, each with its title as the first head; tables of one form are one."""
    tables: dict[str, list[Figure]] = {}
    for figure in run.figures:
        tables.setdefault(figure.table, []).append(figure)
    forms = {title: _form(figures) for title, figures in tables.items()}
    parts, done = [], set()
    for title, figures in tables.items():
        alike = [one for one, form in forms.items() if form == forms[title]]
        if title in done:
            continue
        if forms[title] and len(alike) > 2:
            parts.append(_stacked({one: tables[one] for one in alike}, run))
            done |= set(alike)
        elif any(one.column for one in figures):
            parts.append(_crossed(title, figures, run))
        else:
            parts.append(_split(title, figures, run) or _listed(title, figures, run))
    return parts


def _form(figures: Sequence[Figure]) -> tuple[str, ...]:
    """The rows and the columns of a table; empty where it has no columns."""
    if not any(one.column for one in figures):
        return ()
    return tuple(dict.fromkeys(text for one in figures for text in (one.what, one.column)))


def _listed(title: str, figures: Sequence[Figure], run: Run) -> str:
    """A row a figure; columns that say nothing are left out."""
    cells = {head: [cell(one, run) for one in figures] for head, cell in COLUMNS}
    heads = [head for head, column in cells.items() if any(column)]
    rows = zip((one.what for one in figures), *(cells[head] for head in heads), strict=True)
    return table((title, *heads), rows)


def _split(title: str, figures: Sequence[Figure], run: Run) -> str:
    """Rows called "where: what", the same what everywhere, as rows against columns; else empty."""
    groups: dict[str, dict[str, Figure]] = {}
    for one in figures:
        where, _, what = one.what.partition(": ")
        groups.setdefault(where, {})[what] = one
    whats = {tuple(group) for group in groups.values()}
    if len(groups) < 2 or len(whats) != 1 or len(figures) == len(groups):
        return ""
    rows = (
        (what, *(_crossing(group[what], run) for group in groups.values())) for what in whats.pop()
    )
    return table((title, *groups), rows)


def _crossed(title: str, figures: Sequence[Figure], run: Run) -> str:
    """Rows against columns; rows called "which: what", the same what of each, are one of each."""
    columns = list(dict.fromkeys(one.column for one in figures))
    found: dict[str, dict[str, str]] = {}
    for one in figures:
        found.setdefault(one.what, {})[one.column] = _crossing(one, run)
    groups: dict[str, list[str]] = {}
    for what in found:
        groups.setdefault(what.partition(": ")[0], []).append(what)
    parts = [tuple(one.partition(": ")[2] for one in group) for group in groups.values()]
    rows = []
    for group, part in zip(groups.values(), parts, strict=True):
        together = [group] if len(group) > 1 and parts.count(part) > 2 else [[one] for one in group]
        for whats in together:
            label = f"{whats[0]}; {'; '.join(part[1:])}" if len(whats) > 1 else whats[0]
            rows.append(
                (label, *(_joined(found[what].get(one, "") for what in whats) for one in columns))
            )
    return table((title, *columns), rows)


def _stacked(tables: Mapping[str, Sequence[Figure]], run: Run) -> str:
    """Several tables with the same rows and columns: a row for each, a column for each row."""
    first = next(iter(tables.values()))
    whats, columns = (
        list(dict.fromkeys(texts))
        for texts in ((one.what for one in first), (one.column for one in first))
    )
    rows = []
    for title, figures in tables.items():
        found = {(one.what, one.column): _crossing(one, run) for one in figures}
        rows.append((title, *(_joined(found[what, one] for one in columns) for what in whats)))
    return table(("; ".join(columns), *whats), rows)


def _joined(cells: Iterable[str]) -> str:
    return "; ".join(one for one in cells if one)


def _crossing(figure: Figure, run: Run) -> str:
    against = ratio(figure, run)
    beside = [f"{against} times"] if against else []
    beside += [between] if (between := interval(figure, run)) else []
    beside += [f"wanted {wanted(figure)}"] if figure.missed else []
    return measured(figure) + (f" ({', '.join(beside)})" if beside else "")


def _joint(unit: str) -> str:
    return "" if unit in ("", "x") else " "
