"""Runs the benchmarks and keeps what they find in `benchmarks/results.json`.

    python -m benchmarks.core.run [--only NAME ...] [--quick] [--results FILE]
    python -m benchmarks.core.run --front [--quick] [--results FILE]

Each runs in a process of its own, so that none disturbs the next, and is kept as soon as it is
done. Measure on a machine that does nothing else. `--front` measures what the README shows, in one
run at one commit, and keeps it as a whole in `benchmarks/front.json`, or not at all. `--quick` is
for trying a benchmark: its figures come from too few rounds, go into `quick.json`, are marked so,
and are refused by `benchmarks.core.render`.
"""

import argparse
import importlib
import os
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import NoReturn

from benchmarks import ROOT
from benchmarks.core.environment import Environment, commit, environment, load
from benchmarks.core.figures import Measured, NotHere
from benchmarks.core.front import of_the_front
from benchmarks.core.listed import BENCHMARKS, FRONT
from benchmarks.core.results import FILE, FRONT_FILE, IDLE_LOAD, BadResults, Results, read, write

PROGRAM = "benchmarks.core.run"
QUICK_FILE = FILE.with_name("quick.json")
LIMIT_S = 7200.0
"""Nothing takes that long; what does, hangs."""
PATIENCE_S = 20.0
OK, FAILED, LEFT_OUT = 0, 1, 3


class Broken(Exception):
    """A benchmark ended without figures; what it printed says why."""


def measure(name: str, quick: bool, front: bool = False) -> Measured | None:
    """What a benchmark finds, in a process of its own; None where its needs are not here."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "found.json"
        command = [sys.executable, "-m", PROGRAM, "--here", name, "--results", str(file)]
        command += [*(["--quick"] if quick else []), *(["--front"] if front else [])]
        with subprocess.Popen(command, cwd=ROOT) as process:
            code = _ended(process)
        if code == LEFT_OUT:
            return None
        if code != OK:
            raise Broken(f"{name}: ended with code {code}")
        return Measured.model_validate_json(file.read_bytes())


def measure_here(name: str, quick: bool, file: Path, front: bool = False) -> int:
    """Be that process."""
    one = BENCHMARKS[name]
    try:
        module = importlib.import_module(one.module)
        found = getattr(module, one.front if front else "measure")(quick)
    except NotHere as reason:
        print(f"{name}: left out: {reason}", flush=True)
        return LEFT_OUT
    except (Exception, KeyboardInterrupt):  # noqa: BLE001 - whatever it was, all is told
        traceback.print_exc()
        return FAILED
    file.write_text(found.model_dump_json(), encoding="utf-8")
    return OK


class Running:
    """One run of several benchmarks, on this machine as it is and at this commit."""

    def __init__(self, quick: bool, front: bool) -> None:
        self._quick, self._front = quick, front
        self._where: Environment = environment()
        self.commit = commit()
        self._busy = load()
        self.failed: list[str] = []
        if self._busy > IDLE_LOAD * self._where.machine.cores:
            print(f"The machine is busy (load {self._busy}): trust ratios only.", flush=True)

    def into(self, results: Results, name: str) -> Results:
        """These results with what a benchmark finds; as they are where it finds nothing."""
        began, clock_s = datetime.now(UTC), time.monotonic()
        print(f"{name}: {BENCHMARKS[name].about} ...", flush=True)
        try:
            found = measure(name, self._quick, self._front)
        except Broken as reason:
            print(reason, file=sys.stderr, flush=True)
            self.failed.append(name)
            return results
        took_s = time.monotonic() - clock_s
        if found is None:
            return results
        print(f"{name}: {len(found.figures)} figures in {took_s:.0f} s", flush=True)
        return results.with_run(
            name,
            of_the_front(name, found) if self._front else found,
            self._where,
            began=began,
            took_s=took_s,
            commit=self.commit,
            quick=self._quick,
            load_before=self._busy,
        )


def run(names: Sequence[str], quick: bool, file: Path) -> int:
    """Run these one after the other and keep what they find; the exit code."""
    running = Running(quick, front=False)
    for name in names:
        write(running.into(read(file), name), file)
    return _told(running.failed)


def run_front(quick: bool, file: Path) -> int:
    """Measure what the README shows, and keep it if none has failed; the exit code.

    Refuses to begin, and to keep anything, where the code is not that of a commit.
    """
    running, kept = Running(quick, front=True), read(file)
    if not quick:
        _refuse_changes(running.commit)
    if kept.runs:
        took_s = sum(run.took_s for run in kept.runs.values())
        print(f"{', '.join(FRONT)}: the last time {took_s / 60:.0f} minutes.", flush=True)
    found = Results()
    for name in FRONT:
        found = running.into(found, name)
    if not quick:
        _refuse_changes(commit(), running.commit)
    if not running.failed:
        write(found, file)
    return _told(running.failed)


def _refuse_changes(now: tuple[str, bool], begun: tuple[str, bool] | None = None) -> None:
    name, changed = now
    if not name or changed:
        raise BadResults("the front table is of one commit: commit your changes first")
    if begun not in (None, now):
        raise BadResults(f"not kept: it began at commit {begun[0] if begun else ''}, is {name} now")


def _told(failed: Sequence[str]) -> int:
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return FAILED if failed else OK


def _ended(process: "subprocess.Popen[bytes]") -> int:
    """Its exit code; one that takes too long is interrupted, so that it ends what it started."""
    try:
        return process.wait(LIMIT_S)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
        return FAILED


def _end_now(code: int) -> NoReturn:
    """End this process; a thread that a benchmark has lost must not hold up the next."""
    sys.stdout.flush(), sys.stderr.flush()
    os._exit(code)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for; the exit code."""
    known = "\n".join(f"  {name:20} {one.about}" for name, one in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        description="Measure, and keep the figures in benchmarks/results.json.",
        epilog=f"benchmarks, in the order in which they run:\n{known}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    names = tuple(BENCHMARKS)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME")
    which.add_argument(
        "--front", action="store_true", help="what the README shows, at one commit, in 20 minutes"
    )
    parser.add_argument("--quick", action="store_true", help="try it out: too few rounds to quote")
    parser.add_argument("--results", type=Path, metavar="FILE")
    parser.add_argument("--here", choices=names, help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    whole = FRONT_FILE if asked.front else FILE
    file = asked.results or (QUICK_FILE if asked.quick else whole)
    if asked.here:
        _end_now(measure_here(asked.here, asked.quick, file, asked.front))
    try:
        if asked.front:
            return run_front(asked.quick, file)
        return run([name for name in names if name in asked.only], asked.quick, file)
    except BadResults as error:
        print(error, file=sys.stderr)
        return FAILED


if __name__ == "__main__":
    sys.exit(main())
