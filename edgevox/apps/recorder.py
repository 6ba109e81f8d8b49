"""`edgevox-recorder`: records a robot's topics, and judges a scenario on a robot that runs.

`RecorderArguments` is its command line, as one value.
"""

import argparse
import math
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.metrics import serve_recorders_metrics
from edgevox.apps.run_program import (
    ShutdownSignals,
    Terminated,
    run_program,
    secure_ros2,
    set_up_logs,
)
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError, InvalidValue, install_extra
from edgevox.core.settings import Settings, load_settings
from edgevox.core.status import Components
from edgevox.ops.health import Health
from edgevox.ros2 import split_ros_args
from edgevox.ros2.open import check_environment
from edgevox.ros2.recordings import WhenFull, new_folder, used_bytes
from edgevox.scenario import Scenario, load_scenario, run_scenario
from edgevox.scenario.run import StepResult, heading, line, summary

if TYPE_CHECKING:
    from edgevox.ros2.recorder import Recorder


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
    """The parsed command line of `edgevox-recorder`."""

    settings: Settings
    output: Path
    topics: tuple[str, ...]
    max_size_mb: float
    spare_mb: float
    most_mb: float | None
    when_full: WhenFull
    duration_s: float | None
    mend: bool
    scenario: Path | None
    wait_s: float
    ros_args: tuple[str, ...]


def parse_arguments(argv: Sequence[str]) -> RecorderArguments:
    """Read a command line. Raises `InvalidValue`; ends the process for what makes no sense."""
    own, ros = split_ros_args(argv)
    arguments = _parser().parse_args(own)
    most = None if arguments.most is None else _at_least("most", arguments.most, 0.01)
    if most is not None and arguments.when_full is WhenFull.RING:  # the open file never goes
        _at_least("most", most, 2 * arguments.max_size)
    return RecorderArguments(
        load_settings(given_flags(arguments), arguments.config),
        arguments.output,
        tuple(arguments.topics),
        _at_least("max_size", arguments.max_size, 0.01),
        _at_least("spare", arguments.spare, 0),
        most,
        arguments.when_full,
        arguments.duration,
        arguments.mend,
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
        description="Record a robot's topics as MCAP files, and play scenarios on the robot.",
        epilog="Exit codes: 0 OK, 1 the scenario failed, 2 wrong arguments, 74 messages lost.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("recordings"),
        metavar="DIR",
        help="folder in which the recording's own folder is made [default: recordings]",
    )
    parser.add_argument(
        "--topics",
        nargs="+",
        default=(),
        metavar="NAME",
        help="record only these topics, by the contract's names or as NAME:TYPE"
        " [default: all but sound]",
    )
    parser.add_argument(
        "--max-size",
        type=float,
        default=256,
        metavar="MB",
        help="start a new file at this size [default: 256]",
    )
    parser.add_argument(
        "--spare",
        type=float,
        default=100,
        metavar="MB",
        help="disk space to leave free [default: 100]",
    )
    parser.add_argument(
        "--most",
        type=float,
        metavar="MB",
        help="size limit of all recordings in DIR together [default: none]",
    )
    parser.add_argument(
        "--when-full",
        type=WhenFull,
        choices=tuple(WhenFull),
        default=WhenFull.END,
        help="at --most: end (a scenario still plays to its end); wait for room; or ring:"
        " remove the oldest finished files, also for --spare [default: end]",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--duration", type=float, metavar="S", help="end after this many seconds")
    what.add_argument(
        "--mend",
        action="store_true",
        help="record nothing: only mend what earlier recorders left unfinished in DIR",
    )
    what.add_argument(
        "--scenario",
        type=Path,
        metavar="FILE",
        help="play this scenario on the robot, and exit with its result",
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


MB = 1_000_000
NOT_ALL_RECORDED = 74
"""Exit code where the disk, or its speed, lost messages and nothing else went wrong."""


@with_streams("edgevox-recorder")
def main(argv: Sequence[str] | None = None) -> int:
    """Run it; the process's exit code."""
    lost: list[str] = []
    code = run_program(
        "edgevox-recorder", lambda: _prepare(sys.argv[1:] if argv is None else argv, lost)
    )
    for text in lost:
        show(f"edgevox-recorder: {text}", error=True)
    return code or (NOT_ALL_RECORDED if lost else code)


def main_under_agent() -> int:
    """Run it as the console does; it ends with its standard input, which the agent holds."""
    threading.Thread(target=_end_with_agent, name="agent", daemon=True).start()
    return main()


def _end_with_agent() -> None:
    while os.read(sys.stdin.fileno(), 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def _prepare(argv: Sequence[str], lost: list[str]) -> Callable[[], bool]:
    """Return the function to run, which returns whether the scenario went well.

    `lost` gets the losses.
    """
    asked = parse_arguments(argv)
    set_up_logs("edgevox-recorder", asked.settings)
    for module, what in (("rclpy", "ROS 2 Jazzy"), ("mcap", install_extra("recorder"))):
        if find_spec(module) is None:
            raise EdgeVoxError(f"{module}: got no module, expected {what}")
    if asked.mend:
        return lambda: _mend(asked.output)
    check_environment(os.environ)
    secure_ros2("edgevox-recorder", asked.settings)
    scenario = load_scenario(asked.scenario) if asked.scenario else None
    from edgevox.ros2.recorder import choose_topics

    choose_topics(asked.settings.agent_namespace, asked.topics)
    return lambda: _record(asked, scenario, lost)


def _mend(output: Path) -> bool:
    from edgevox.ros2.recorder import mend_recordings

    mend_recordings(output, lambda: False)
    return True


def _record(asked: RecorderArguments, scenario: Scenario | None, lost: list[str]) -> bool:
    from edgevox.ros2.recorder import Disk, Recorder, choose_topics

    namespace = asked.settings.agent_namespace
    folder = new_folder(asked.output, datetime.now(UTC))
    most = None if asked.most_mb is None else round(asked.most_mb * MB)
    disk = Disk(
        folder,
        round(asked.max_size_mb * MB),
        round(asked.spare_mb * MB),
        most,
        asked.when_full,
    )
    if disk.when_full is WhenFull.END and most is not None and used_bytes(asked.output) >= most:
        used = used_bytes(asked.output) / MB
        raise InvalidValue("most", asked.most_mb, f"more than the {used:g} MB in {asked.output}")
    topics = choose_topics(namespace, asked.topics)
    try:
        with ExitStack() as stack, ShutdownSignals(asked.settings.leave_s):
            recorder = Recorder(namespace, topics, disk, asked.ros_args)
            stack.callback(_conclude, recorder, folder, lost)
            stack.callback(recorder.close)
            health = Health(Components(recorder))
            _serve_health(stack, asked.settings, health)
            serve_recorders_metrics(stack, asked.settings, health, recorder)
            play = _stage(stack, recorder, asked, scenario) if scenario else None
            recorder.start()
            health.started()
            show(f"recording {len(recorder.topics)} topics of {namespace} to {folder}")
            if play:
                return play()
            recorder.full.wait(asked.duration_s)
    except (Terminated, KeyboardInterrupt):
        return scenario is None
    return True


def _stage(
    stack: ExitStack, recorder: "Recorder", asked: RecorderArguments, scenario: Scenario
) -> Callable[[], bool]:
    from edgevox.ros2.recorder import TopicHarness

    harness = TopicHarness(recorder.ros)

    def play() -> bool:
        stack.callback(harness.close)
        harness.wait_for_robot(scenario, asked.wait_s)
        show(heading(scenario, asked.scenario.name if asked.scenario else "", harness.name))
        if scenario.settings:
            show("its settings are not made: the robot runs with its own")
        last: list[StepResult] = []

        def tell(outcome: StepResult) -> None:
            last[:] = [outcome]
            show(line(outcome))

        passed = run_scenario(scenario, harness, tell)
        show(summary(scenario, last[0] if last else None))
        return passed

    return play


def _serve_health(stack: ExitStack, settings: Settings, health: Health) -> None:
    if settings.health_port:
        from edgevox.ops.health import HealthServer

        server = HealthServer(health, settings.health_host, settings.health_port)
        stack.callback(server.close)
        server.start()


def _conclude(recorder: "Recorder", folder: Path, lost: list[str]) -> None:
    show(f"{recorder.written} messages in {recorder.files} files in {folder}")
    dropped = recorder.dropped
    if dropped or recorder.fault:
        most = ", ".join(f"{count} of {name}" for name, count in list(dropped.items())[:5])
        lost.append(f"not all was recorded: {recorder.fault or 'dropped ' + most}")
