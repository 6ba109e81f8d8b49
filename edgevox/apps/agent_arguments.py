"""What `edgevox-agent` was asked on its command line, as one value."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.robots import ROBOTS
from edgevox.apps.skill_setup import about_packages
from edgevox.ros2 import split_ros_args


@dataclass(frozen=True)
class AgentArguments:
    """The command line, taken apart; nothing in it is validated but the robot's name.

    `flags` are only those settings that were given. `ros_args` go to ROS 2 as they are.
    """

    robot: str
    flags: dict[str, Any]
    config: Path | None
    scenario: Path | None
    snapshot: Path | None
    check: bool
    ros_args: tuple[str, ...]


def parse_arguments(argv: Sequence[str], complaint: str = "") -> AgentArguments:
    """Read a command line; ends the process for one that makes no sense, as argparse does.

    `complaint` is said with what is wrong then: why a robot may be missing.
    """
    own, ros = split_ros_args(argv)
    arguments = _parser(complaint).parse_args(own)
    return AgentArguments(
        arguments.robot,
        given_flags(arguments),
        arguments.config,
        arguments.scenario,
        arguments.snapshot,
        arguments.check,
        tuple(ros),
    )


class _ArgumentParser(argparse.ArgumentParser):
    """Loads robots and packages with skills only for those who ask for help."""

    def __init__(self, prog: str, description: str, epilog: str, complaint: str) -> None:
        super().__init__(prog, description=description, epilog=epilog)
        self._complaint = complaint
        self._robot = self.add_argument("robot", choices=ROBOTS, metavar="ROBOT")

    def error(self, message: str) -> NoReturn:
        super().error("\n".join(filter(None, (message, self._complaint))))

    def format_help(self) -> str:
        self._robot.help = "; ".join(f"{name}: {one.about}" for name, one in ROBOTS.items())
        self.epilog = f"{self.epilog} {about_packages()}"
        return super().format_help()


def _parser(complaint: str) -> argparse.ArgumentParser:
    parser = _ArgumentParser(
        prog="edgevox-agent",
        description="A voice agent with a robot's body.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
        complaint=complaint,
    )
    parser.add_argument("--version", action="version", version=__version__)
    parser.add_argument(
        "--scenario",
        type=Path,
        metavar="FILE",
        help="run this YAML file, as fast as the body can, and say whether all came true",
    )
    parser.add_argument(
        "--snapshot",
        type=Path,
        metavar="FILE",
        help="write a picture of the robot as PNG and leave; with --scenario, of its end",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="check the robot and its files, say what it can do, and leave",
    )
    add_flags(parser)
    return parser
