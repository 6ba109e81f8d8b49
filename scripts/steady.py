"""Run tests again and again: on an idle machine, a busy one, a slow one, and in random order.

`make steady` runs the whole matrix, which takes hours, `make steady ARGS="--only idle,burned"` a
part of it, and ARGS="--only nice --runs 2 tests/robots/test_tui.py" other tests, so often.
"""

import argparse
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BURN = "while True: pass"
QUICK = (
    *("tests/robots", "tests/programs", "tests/unit", "tests/talk", "tests/wrong"),
    "training/tests",
)
LONG = ("tests/ros2", "tests/models")
SUMMARY = re.compile(r"^=* ?(\d+ (?:passed|failed|error).*?) in [\d.]+s")
TAIL = 40


@dataclass(frozen=True, slots=True)
class Condition:
    """A way in which tests are run so often: what runs beside them, what they may have."""

    name: str
    what: str
    tests: Sequence[str]
    runs: int
    burners: int = 0
    before: Sequence[str] = ()
    options: Sequence[str] = ()


CORES = os.cpu_count() or 1
BESIDE = ("-n", str(CORES), "--dist", "loadfile")
CONDITIONS = (
    Condition("idle", "nothing else to do", QUICK, 5),
    Condition("burned", "every core burned", QUICK, 5, burners=CORES),
    Condition("core", "one core", QUICK, 5, before=("taskset", "-c", "0")),
    Condition("nice", "last in the queue, one core burned", QUICK, 5, 1, ("nice", "-n", "19")),
    Condition(
        "random",
        "in random order, with other examples",
        QUICK,
        5,
        before=("env", "TEST_EXAMPLES=search"),
        options=("--random-order-seed={run}",),
    ),
    Condition(
        "wire",
        "one core burned",
        LONG,
        2,
        burners=1,
        options=("--deselect=tests/ros2/test_chaos.py",),
    ),
)


@dataclass(frozen=True, slots=True)
class Run:
    """How one run of one condition ended."""

    condition: Condition
    number: int
    code: int
    took_s: float
    summary: str


@contextmanager
def burning(cores: int) -> Iterator[None]:
    """So many processes that compute and nothing else."""
    burners = [subprocess.Popen([sys.executable, "-c", BURN]) for _ in range(cores)]
    try:
        yield
    finally:
        for one in burners:
            one.kill()
            one.wait()


def run(condition: Condition, number: int, tests: Sequence[str]) -> Run:
    """Run these tests once in this condition; what pytest printed last, if it failed."""
    options = [option.format(run=number) for option in condition.options]
    command = [*condition.before, sys.executable, "-m", "pytest", "-q", *BESIDE, *options, *tests]
    begun_s = time.monotonic()
    with burning(condition.burners):
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    lines = done.stdout.splitlines()
    found = [match[1] for match in map(SUMMARY.match, lines) if match]
    if done.returncode:
        sys.stdout.write("\n".join([*lines[-TAIL:], ""]))
    took_s = time.monotonic() - begun_s
    return Run(condition, number, done.returncode, took_s, found[-1] if found else "no summary")


def row(one: Run) -> str:
    """A line of the table."""
    verdict = "passed" if one.code == 0 else f"FAILED ({one.code})"
    times = f"{one.number} of {one.condition.runs}"
    return f"{one.condition.name:8} {times:7} {verdict:11} {one.took_s:6.0f} s  {one.summary}"


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """What was asked for; ends the program where it makes no sense."""
    names = [one.name for one in CONDITIONS]
    told = "; ".join(f"{one.name}: {one.what}" for one in CONDITIONS)
    parser = argparse.ArgumentParser(description=__doc__, epilog=told)
    parser.add_argument("--only", default=",".join(names), help="conditions, with commas between")
    parser.add_argument("--runs", type=int, help="how often, instead of as often as each asks for")
    parser.add_argument("tests", nargs="*", help="instead of those of each condition")
    asked = parser.parse_args(arguments)
    unknown = set(asked.only.split(",")) - set(names)
    if unknown:
        parser.error(f"--only: got {', '.join(sorted(unknown))}, expected {', '.join(names)}")
    if asked.runs is not None and asked.runs < 1:
        parser.error(f"--runs: got {asked.runs}, expected 1 or more")
    return asked


def main(arguments: Sequence[str]) -> int:
    """0 if every run passed."""
    asked = parse(arguments)
    done: list[Run] = []
    for known in CONDITIONS:
        if known.name not in asked.only.split(","):
            continue
        condition = replace(known, runs=asked.runs or known.runs)
        for number in range(1, condition.runs + 1):
            done.append(run(condition, number, asked.tests or condition.tests))
            sys.stdout.write(row(done[-1]) + "\n")
            sys.stdout.flush()
    failed = sum(one.code != 0 for one in done)
    sys.stdout.write("\n" + "\n".join(map(row, done)) + f"\n{failed} of {len(done)} runs failed\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
