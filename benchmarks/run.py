"""Runs the benchmarks and keeps what they find in `results.json`.

    python benchmarks/run.py [--only NAME ...] [--quick] [--results FILE]

Each runs in a process of its own, so that none disturbs the next, and is kept as soon as it is
done. Measure on a machine that does nothing else. `--quick` is for trying a benchmark: its figures
come from too few rounds, go into `quick.json`, are marked so, and are refused by `render.py`.
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

from environment import commit, environment, load
from figures import Measured, NotHere
from results import FILE, IDLE_LOAD, BadResults, read, write

BENCHMARKS = {
    "sim": "steps, scans and plans of the 2D apartment",
    "latency": "how fast a running agent answers and stops",
    "memory": "how much memory the default set takes, hearing and speaking",
    "spine": "through how much code a sentence passes before a wheel turns",
    "stop": "how soon a robot stands, by every way to say so",
    "ros2": "messages, round trips, an idle robot, rates, images",
    "security": "what DDS security costs a message; needs a Fast DDS that has it",
    "language_model": "the language model beside plain llama-cpp-python",
    "shared_llm": "one language model for 1 to 50 robots, with and without a bound on its queue",
    "hearing": "speech to text beside plain faster-whisper",
    "noise": "plain commands in quiet and in noise, and what is heard out of noise alone",
    "noise_ways": "noise suppression, gain control and a larger model, for commands in noise",
    "stop_words": "which stop words are heard by their sound, and what else is taken for one",
    "stop_words_languages": "English stop words by their sound where another language is spoken",
    "endings": "when an utterance counts as over, and how often within a sentence",
    "duplex": "who is heard through the robot's own voice, and whether it hears itself",
    "wake_words": "both engines of wake words: misses, false alarms, cost",
    "robots": "every body beside its simulator alone",
    "overhead": "what logs, metrics and diagnostics cost",
    "console": "a browser's stop, map and sound, and what ten of them cost",
    "voice": "hearing, answering aloud, barging in, an hour of listening",
    "corpus": "what becomes of what strangers say, and whether anything moves that should not",
    "discovery_scale": "how soon many agents find each other, and what it costs",
    "image": "size and start of the container's image",
}
"""Each is a module here, in the order in which they run."""
QUICK_FILE = FILE.with_name("quick.json")
LIMIT_S = 7200.0
"""Nothing takes that long; what does, hangs."""
PATIENCE_S = 20.0
OK, FAILED, LEFT_OUT = 0, 1, 3


class Broken(Exception):
    """A benchmark ended without figures; what it printed says why."""


def measure(name: str, quick: bool) -> Measured | None:
    """What a benchmark finds, in a process of its own; None where its needs are not here."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "found.json"
        command = [sys.executable, __file__, "--here", name, "--results", str(file)]
        with subprocess.Popen([*command, *(["--quick"] if quick else [])]) as process:
            code = _ended(process)
        if code == LEFT_OUT:
            return None
        if code != OK:
            raise Broken(f"{name}: ended with code {code}")
        return Measured.model_validate_json(file.read_bytes())


def measure_here(name: str, quick: bool, file: Path) -> int:
    """Be that process."""
    try:
        found = importlib.import_module(name).measure(quick)
    except NotHere as reason:
        print(f"{name}: left out: {reason}", flush=True)
        return LEFT_OUT
    except (Exception, KeyboardInterrupt):  # noqa: BLE001 - whatever it was, all is told
        traceback.print_exc()
        return FAILED
    file.write_text(found.model_dump_json(), encoding="utf-8")
    return OK


def run(names: Sequence[str], quick: bool, file: Path) -> int:
    """Run these one after the other and keep what they find; the exit code."""
    where, code, busy, failed = environment(), commit(), load(), []
    if busy > IDLE_LOAD * where.machine.cores:
        print(f"The machine is busy (load {busy}): trust ratios only.", flush=True)
    for name in names:
        began, clock_s = datetime.now(UTC), time.monotonic()
        print(f"{name}: {BENCHMARKS[name]} ...", flush=True)
        try:
            found = measure(name, quick)
        except Broken as reason:
            print(reason, file=sys.stderr, flush=True)
            failed.append(name)
            continue
        took_s = time.monotonic() - clock_s
        if found:
            kept = read(file).with_run(
                name,
                found,
                where,
                began=began,
                took_s=took_s,
                commit=code,
                quick=quick,
                load_before=busy,
            )
            write(kept, file)
            print(f"{name}: {len(found.figures)} figures in {took_s:.0f} s", flush=True)
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
    known = "\n".join(f"  {name:14} {about}" for name, about in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        description="Measure, and keep the figures in benchmarks/results.json.",
        epilog=f"benchmarks, in the order in which they run:\n{known}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    names = tuple(BENCHMARKS)
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME")
    parser.add_argument("--quick", action="store_true", help="try it out: too few rounds to quote")
    parser.add_argument("--results", type=Path, metavar="FILE")
    parser.add_argument("--here", choices=names, help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    file = asked.results or (QUICK_FILE if asked.quick else FILE)
    if asked.here:
        _end_now(measure_here(asked.here, asked.quick, file))
    try:
        return run([name for name in names if name in asked.only], asked.quick, file)
    except BadResults as error:
        print(error, file=sys.stderr)
        return FAILED


if __name__ == "__main__":
    sys.exit(main())
