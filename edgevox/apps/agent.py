"""`edgevox-agent`: an agent with a body, aloud, on the terminal and on ROS 2."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from edgevox.apps.agent_arguments import AgentArguments, parse_arguments
from edgevox.apps.check_robot import check_robot
from edgevox.apps.play import play, read_script
from edgevox.apps.plugins import Plugins, bring_plugins, plugins_folder
from edgevox.apps.robots import build_body, learn_robots, open_places
from edgevox.apps.run_program import run_program, secure_ros2, set_up_logs
from edgevox.apps.serving import serve
from edgevox.apps.shutdown_signals import ShutdownSignals, Terminated
from edgevox.apps.snapshot import take_snapshot
from edgevox.apps.streams import with_streams
from edgevox.core.settings import load_settings

IN_THE_HAND = 0.0
"""A speed of the world: time passes only when somebody lets it."""


@with_streams("edgevox-agent")
def main(argv: Sequence[str] | None = None) -> int:
    """Run the agent; the process's exit code."""
    given = sys.argv[1:] if argv is None else argv
    return run_program("edgevox-agent", lambda: _prepare(given))


def _prepare(argv: Sequence[str]) -> Callable[[], bool]:
    """What to run; it says whether it went well. Raises `EdgeVoxError` for what cannot be."""
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
