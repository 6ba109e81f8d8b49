"""`edgevox-agent`: an agent with a body, aloud, on the terminal and on ROS 2.

`AgentArguments` is its command line, as one value. `--check` prints a robot's skills, as the given
files and settings make them.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from edgevox import __version__
from edgevox.apps.agent.build import serve
from edgevox.apps.agent.check import check_robot
from edgevox.apps.agent.play import play, read_script
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.plugins import Plugins, bring_plugins, plugins_folder
from edgevox.apps.robots import (
    ROBOTS,
    about_packages,
    build_body,
    learn_robots,
    open_places,
)
from edgevox.apps.run_program import (
    ShutdownSignals,
    Terminated,
    run_program,
    secure_ros2,
    set_up_logs,
)
from edgevox.apps.streams import with_streams
from edgevox.core.settings import load_settings
from edgevox.robots.pictures import take_snapshot
from edgevox.ros2 import split_ros_args


@dataclass(frozen=True)
class AgentArguments:
    """The parsed command line; only the robot's name is validated."""

    robot: str
    flags: dict[str, Any]
    """Only the settings that were given."""
    config: Path | None
    scenario: Path | None
    snapshot: Path | None
    check: bool
    ros_args: tuple[str, ...]
    """Passed on to ROS 2."""


def parse_arguments(argv: Sequence[str], complaint: str = "") -> AgentArguments:
    """Read a command line; ends the process for one that makes no sense, as argparse does.

    `complaint` is said with what is wrong then: why a robot may be missing.
    """
    own, ros = split_ros_args(argv)
    arguments = agent_parser(complaint).parse_args(own)
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
        usage = "%(prog)s ROBOT [FLAG ...] [--ros-args ...]"
        super().__init__(prog, usage, description=description, epilog=epilog)
        self._complaint = complaint
        self._robot = self.add_argument("robot", choices=ROBOTS, metavar="ROBOT")

    def error(self, message: str) -> NoReturn:
        super().error("\n".join(filter(None, (message, self._complaint))))

    def format_help(self) -> str:
        self._robot.help = "; ".join(f"{name}: {one.about}" for name, one in ROBOTS.items())
        self.epilog = f"{self.epilog} {about_packages()}"
        return super().format_help()


def agent_parser(complaint: str = "") -> argparse.ArgumentParser:
    """The command line of edgevox-agent; `complaint` is said with what is wrong."""
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
        help="play this scenario (YAML) as fast as the robot can, print the result, and exit",
    )
    parser.add_argument(
        "--snapshot",
        type=Path,
        metavar="FILE",
        help="save a PNG picture of the robot and exit; with --scenario, after it ends",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="check the robot and its files, print what it can do, and exit",
    )
    add_flags(parser)
    return parser


IN_THE_HAND = 0.0
"""A speed of the world: time passes only when somebody lets it."""


@with_streams("edgevox-agent")
def main(argv: Sequence[str] | None = None) -> int:
    """Run the agent; the process's exit code."""
    given = sys.argv[1:] if argv is None else argv
    return run_program("edgevox-agent", lambda: _prepare(given))


def _prepare(argv: Sequence[str]) -> Callable[[], bool]:
    """Return the function to run; it returns whether it went well. Raises `EdgeVoxError`."""
    plugins = bring_plugins(plugins_folder(argv))
    learn_robots()
    asked = parse_arguments(argv, plugins.complaint)
    if asked.scenario:
        return _prepare_scenario(asked, asked.scenario, plugins)
    settings = load_settings(asked.flags, asked.config)
    set_up_logs("edgevox-agent", settings)
    secure_ros2("edgevox-agent", settings)
    plugins.log()
    if snapshot := asked.snapshot:
        drawn = build_body(asked.robot, settings, IN_THE_HAND)
        return lambda: take_snapshot(drawn, snapshot)
    if asked.check:
        checked = build_body(asked.robot, settings, IN_THE_HAND)
        return lambda: check_robot(checked, settings)
    body = build_body(asked.robot, settings)
    open_places(body, settings)
    return lambda: serve(settings, body, asked.ros_args)


def _prepare_scenario(asked: AgentArguments, file: Path, plugins: Plugins) -> Callable[[], bool]:
    script = read_script(file, asked.robot)
    settings = load_settings(script.flags(asked.flags), asked.config)
    set_up_logs("edgevox-agent", settings)
    secure_ros2("edgevox-agent", settings)
    plugins.log()
    body = build_body(asked.robot, settings, IN_THE_HAND)
    if settings.places:  # a run of a scenario remembers nothing of the last one, unless it says so
        open_places(body, settings)
    return lambda: _interruptible(
        lambda: play(script, settings, body, snapshot=asked.snapshot, ros_args=asked.ros_args),
        settings.leave_s,
    )


def _interruptible(run: Callable[[], bool], leave_s: float) -> bool:
    """Run it; a signal that ends it early means that it did not go well."""
    try:
        with ShutdownSignals(leave_s):
            return run()
    except (Terminated, KeyboardInterrupt):
        return False
