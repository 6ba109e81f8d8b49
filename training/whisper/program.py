"""What both trainings are asked on the command line, and how they write their files."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import IO


def add_options(parser: argparse.ArgumentParser, steps: int) -> None:
    """Where to begin, for how long, where it computes, and of which clips."""
    parser.add_argument("--anew", action="store_true", help="not from what the package has")
    parser.add_argument("--steps", type=int, default=steps, help="to learn in all")
    parser.add_argument("--device", default="cpu", help="PyTorch's name of where it computes")
    parser.add_argument("--processes", type=int, default=1, help="that make examples beside it")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")


def write_whole(file: Path, write: Callable[[IO[bytes]], None]) -> None:
    """Let `write` write all of it, then put it in the file's place."""
    part = file.with_suffix(".new")
    with part.open("wb") as out:
        write(out)
    part.replace(file)
