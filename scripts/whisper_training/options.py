"""What both trainings are asked on the command line."""

import argparse


def add_options(parser: argparse.ArgumentParser, steps: int) -> None:
    """Where to begin, for how long, where it computes, and of which clips."""
    parser.add_argument("--anew", action="store_true", help="not from what the package has")
    parser.add_argument("--steps", type=int, default=steps, help="to learn in all")
    parser.add_argument("--device", default="cpu", help="PyTorch's name of where it computes")
    parser.add_argument("--processes", type=int, default=1, help="that make examples beside it")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")
