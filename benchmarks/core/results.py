"""The files of results: what each benchmark found, when, at which commit and on which machine.

`results.json` has all that docs/figures.md shows. A run of some benchmarks renews those and leaves
the others as they are, so it can hold figures of several days; each tells its own. `front.json` has
what the README shows, of one run.
"""

import hashlib
import json
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from pydantic import Field, ValidationError, model_validator

from benchmarks import ROOT
from benchmarks.core.environment import Environment
from benchmarks.core.figures import Figure, Kept, Measured

FILE = ROOT / "benchmarks" / "results.json"
FRONT_FILE = FILE.with_name("front.json")
INNERMOST = re.compile(r"\{[^{}]*\}")
IDLE_LOAD = 0.25
"""Of a core, times the cores: what a machine may be loaded with before and still be called idle."""


class BadResults(Exception):
    """A file of results that cannot be used; the message says which and why."""


class Run(Kept):
    """One benchmark, measured once. `quick` figures come from too few rounds to be quoted.

    `load_before` is how many programs wanted a core in the minute before the benchmarks began.
    """

    measured: datetime
    took_s: float
    commit: str
    changed: bool
    quick: bool
    load_before: float
    environment: str
    figures: tuple[Figure, ...]
    notes: dict[str, tuple[str, ...]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _whole(self) -> "Run":
        known = [one.id for one in self.figures]
        twice = sorted({one for one in known if known.count(one) > 1})
        if twice:
            raise ValueError(f"ids that are used twice: {', '.join(twice)}")
        lost = sorted({one.baseline for one in self.figures if one.baseline} - set(known))
        if lost:
            raise ValueError(f"baselines that are not there: {', '.join(lost)}")
        return self

    def figure(self, identifier: str) -> Figure:
        """The figure of this id. Raises `BadResults` where there is none."""
        for one in self.figures:
            if one.id == identifier:
                return one
        raise BadResults(f"there is no figure {identifier}")

    def ratio(self, figure: Figure) -> float | None:
        """The figure against its baseline; None where it has none."""
        return figure.value / self.figure(figure.baseline).value if figure.baseline else None


class Results(Kept):
    """All of it. `environments` are shared by the runs, which name them."""

    format: Literal[1] = 1
    environments: dict[str, Environment] = Field(default_factory=dict)
    runs: dict[str, Run] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _known(self) -> "Results":
        lost = sorted({one.environment for one in self.runs.values()} - set(self.environments))
        if lost:
            raise ValueError(f"environments that are not there: {', '.join(lost)}")
        return self

    def run(self, name: str) -> Run:
        """What a benchmark found. Raises `BadResults` where it was never run."""
        if name not in self.runs:
            raise BadResults(f"{name} was not measured: make bench ARGS='--only {name}'")
        return self.runs[name]

    def quick(self) -> list[str]:
        """The benchmarks whose figures must not be quoted."""
        return sorted(name for name, one in self.runs.items() if one.quick)

    def apart(self) -> list[str]:
        """Why these are not the figures of one version on one machine; empty where they are."""
        commits = sorted({one.commit or "no commit" for one in self.runs.values()})
        changed = sorted(name for name, one in self.runs.items() if one.changed)
        found = [f"of {len(commits)} commits ({', '.join(commits)})"] if len(commits) > 1 else []
        found += [f"of code that was in no commit ({', '.join(changed)})"] if changed else []
        if len(self.environments) > 1:
            found.append(f"of {len(self.environments)} machines or sets of libraries")
        return found

    def newest(self) -> datetime | None:
        """When the last figure was measured."""
        return max((one.measured for one in self.runs.values()), default=None)

    def with_run(
        self,
        name: str,
        found: Measured,
        where: Environment,
        *,
        began: datetime,
        took_s: float,
        commit: tuple[str, bool],
        quick: bool,
        load_before: float,
    ) -> "Results":
        """These with one benchmark's renewed; an environment that no run names is dropped."""
        key = hashlib.sha256(where.model_dump_json().encode()).hexdigest()[:10]
        run = Run(
            measured=began.astimezone(UTC).replace(microsecond=0),
            took_s=round(took_s, 1),
            commit=commit[0],
            changed=commit[1],
            quick=quick,
            load_before=load_before,
            environment=key,
            figures=found.figures,
            notes=found.notes,
        )
        runs = dict(sorted({**self.runs, name: run}.items()))
        named = {one.environment for one in runs.values()}
        known = {**self.environments, key: where}
        return Results(
            environments={name: one for name, one in sorted(known.items()) if name in named},
            runs=runs,
        )


def read(file: Path = FILE) -> Results:
    """The results in a file, none where it does not exist. Raises `BadResults`."""
    try:
        return Results.model_validate_json(file.read_bytes())
    except FileNotFoundError:
        return Results()
    except ValidationError as error:
        raise BadResults(f"{file.name}: {error}") from None


def write(results: Results, file: Path = FILE) -> None:
    """Write them, a line a figure, whole or not at all."""
    data = {"format": results.format, **results.model_dump(mode="json", exclude_defaults=True)}
    fresh = file.with_suffix(".new")
    text = json.dumps(data, indent=1, ensure_ascii=False)
    text = INNERMOST.sub(lambda one: re.sub(r"\n *", " ", one[0]), text)
    fresh.write_text(f"{text}\n", encoding="utf-8")
    fresh.replace(file)
