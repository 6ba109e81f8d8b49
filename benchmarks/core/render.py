"""Puts figures into the README, of `front.json`, and into docs/figures.md, of `results.json`, and
draws the plots.

    python -m benchmarks.core.render write|check [--results FILE] [--front FILE] [--provisional]

They stand between ``<!-- figures: NAME -->`` and ``<!-- end -->``; all else is written by hand.
`check` says what was not rendered from the files as they are. Figures of a quick run are refused;
`write --provisional` takes them, for a look at the pages, and `check` still refuses the result.
"""

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

from benchmarks import ROOT
from benchmarks.core.front import BLOCKS, PLOTS
from benchmarks.core.listed import BENCHMARKS
from benchmarks.core.results import FILE, FRONT_FILE, BadResults, Results, read
from benchmarks.core.tables import described, of_benchmark

README, FIGURES = Path("README.md"), Path("docs/figures.md")
PICTURES = Path("docs/images")
BLOCK = re.compile(r"(<!-- figures: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)
AGAIN = "python -m benchmarks.core.render write"


def block(name: str, results: Results) -> str:
    """What stands in a block of this name. Raises `BadResults`."""
    if name in BENCHMARKS:
        return of_benchmark(name, results)
    if name == "environment":
        return described(results.environments.values())
    if name not in BLOCKS:
        known = ", ".join([*BENCHMARKS, "environment", *BLOCKS])
        raise BadResults(f"there is no block {name}; there are {known}")
    return BLOCKS[name](results)


def rendered(results: Results, front: Results, root: Path = ROOT) -> Mapping[Path, str]:
    """What each file should hold."""
    found = {root / FIGURES: _filled(root / FIGURES, results)}
    found[root / README] = _filled(root / README, front)
    for name, draw in PLOTS.items():
        found[root / PICTURES / name] = draw(results)
    return found


def _filled(page: Path, results: Results) -> str:
    return BLOCK.sub(
        lambda match: f"{match[1]}{block(match[2], results)}{match[3]}",
        page.read_text(encoding="utf-8"),
    )


def stale(wanted: Mapping[Path, str]) -> list[Path]:
    """The files that hold something else."""
    return [
        file
        for file, text in wanted.items()
        if not file.exists() or file.read_text(encoding="utf-8") != text
    ]


def age(results: Results, now: datetime) -> str:
    """How old the newest figures are, and of which commits they are."""
    newest = results.newest()
    days = (now - newest).days if newest else 0
    commits = sorted({run.commit for run in results.runs.values()})
    return f"figures of {newest:%Y-%m-%d}, {days} days old, at {', '.join(commits) or 'no commit'}"


def main(arguments: Sequence[str] | None = None, root: Path = ROOT) -> int:
    """Run `write` or `check`; the exit code."""
    parser = argparse.ArgumentParser(description="Render the figures of the benchmarks.")
    parser.add_argument("what", choices=("write", "check"))
    parser.add_argument("--results", type=Path, default=FILE, metavar="FILE")
    parser.add_argument("--front", type=Path, default=FRONT_FILE, metavar="FILE")
    parser.add_argument("--provisional", action="store_true", help="write quick figures, too")
    asked = parser.parse_args(arguments)
    try:
        results, front = read(asked.results), read(asked.front)
        quick = [*results.quick(), *front.quick()]
        if quick and not (asked.provisional and asked.what == "write"):
            raise BadResults(f"measured with --quick: {', '.join(quick)}; run make bench")
        wanted = rendered(results, front, root)
    except BadResults as error:
        sys.stderr.write(f"{error}\n")
        return 1
    old = stale(wanted)
    if asked.what == "write":
        for file in old:
            file.write_text(wanted[file], encoding="utf-8")
        return 0
    sys.stdout.write(f"{age(results, datetime.now(UTC))}\n")
    for reason in front.apart():
        sys.stdout.write(f"README.md: {reason}\n")
    for file in old:
        source = asked.front if file == root / README else asked.results
        name = file.relative_to(root)
        sys.stderr.write(f"{name}: not from the newest {source.name}; run {AGAIN}\n")
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main())
