"""What `edgevox-recorder` was asked on its command line, as one value."""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings, load_settings
from edgevox.ros2 import split_ros_args

SETTINGS = (
    "agent_namespace",
    "health_port",
    "health_host",
    "metrics_port",
    "metrics_host",
    "log_level",
    "log_format",
)


@dataclass(frozen=True)
class RecorderArguments:
    """What to record, where to, and what to judge."""

    settings: Settings
    output: Path
    topics: tuple[str, ...]
    max_size_mb: float
    spare_mb: float
    most_mb: float | None
    duration_s: float | None
    scenario: Path | None
    wait_s: float
    ros_args: tuple[str, ...]


def parse_arguments(argv: Sequence[str]) -> RecorderArguments:
    """Read a command line. Raises `InvalidValue`; ends the process for what makes no sense."""
    own, ros = split_ros_args(argv)
    arguments = _parser().parse_args(own)
    return RecorderArguments(
        load_settings(given_flags(arguments), arguments.config),
        arguments.output,
        tuple(arguments.topics),
        _at_least("max_size", arguments.max_size, 0.01),
        _at_least("spare", arguments.spare, 0),
        None if arguments.most is None else _at_least("most", arguments.most, 0.01),
        arguments.duration,
        arguments.scenario,
        arguments.wait,
        tuple(ros),
    )


def _at_least(name: str, value: float, least: float) -> float:
    if not least <= value < math.inf:
        raise InvalidValue(name, value, f"a number of {least:g} or more")
    return value


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox-recorder",
        description="Record a robot's topics as MCAP files, and judge a scenario on it.",
        epilog="Exit codes: 0 well, 1 the scenario failed, 2 wrong arguments, 74 messages lost.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("recordings"),
        metavar="DIR",
        help="where a folder for this recording is made [default: recordings]",
    )
    parser.add_argument(
        "--topics",
        nargs="+",
        default=(),
        metavar="NAME",
        help="only these, by the contract's names or as NAME:TYPE [default: all but sound]",
    )
    parser.add_argument(
        "--max-size",
        type=float,
        default=256,
        metavar="MB",
        help="begin another file at this size [default: 256]",
    )
    parser.add_argument(
        "--spare",
        type=float,
        default=100,
        metavar="MB",
        help="how much of the disk is left to others [default: 100]",
    )
    parser.add_argument(
        "--most",
        type=float,
        metavar="MB",
        help="end when all its files have this size; a scenario is played to its end",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--duration", type=float, metavar="S", help="end after this many seconds")
    what.add_argument(
        "--scenario",
        type=Path,
        metavar="FILE",
        help="play this scenario on the robot, and end with its verdict",
    )
    parser.add_argument(
        "--wait",
        type=float,
        default=60.0,
        metavar="S",
        help="how long a scenario waits for the robot to appear [default: 60]",
    )
    parser.add_argument(
        "--namespace",
        dest="agent_namespace",
        default=argparse.SUPPRESS,
        metavar="NS",
        help="the same as --agent-namespace",
    )
    add_flags(parser, SETTINGS)
    return parser
