"""`edgevox-recorder`: records a robot's topics, and judges a scenario on a robot that runs."""

import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox.apps.metrics import serve_recorders_metrics
from edgevox.apps.recorder_arguments import RecorderArguments, parse_arguments
from edgevox.apps.run_program import run_program, secure_ros2, set_up_logs
from edgevox.apps.shutdown_signals import ShutdownSignals, Terminated
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.ops.health_checks import Health
from edgevox.scenario import Scenario, load_scenario, run_scenario
from edgevox.scenario.run_scenario import StepResult
from edgevox.scenario.scenario_report import heading, line, summary

if TYPE_CHECKING:
    from edgevox.ros2.recorder import Recorder

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


def _prepare(argv: Sequence[str], lost: list[str]) -> Callable[[], bool]:
    """What to run; it says whether the scenario went well, and in `lost` what was not recorded."""
    asked = parse_arguments(argv)
    set_up_logs("edgevox-recorder", asked.settings)
    for module, what in (("rclpy", "ROS 2 Jazzy"), ("mcap", install_extra("recorder"))):
        if find_spec(module) is None:
            raise EdgeVoxError(f"{module}: got no module, expected {what}")
    secure_ros2("edgevox-recorder", asked.settings)
    scenario = load_scenario(asked.scenario) if asked.scenario else None
    from edgevox.ros2.recorder import choose_topics

    choose_topics(asked.settings.agent_namespace, asked.topics)
    return lambda: _record(asked, scenario, lost)


def _record(asked: RecorderArguments, scenario: Scenario | None, lost: list[str]) -> bool:
    from edgevox.ros2.recorder import Disk, Recorder, choose_topics

    namespace = asked.settings.agent_namespace
    folder = asked.output / f"edgevox-{datetime.now(UTC):%Y%m%d-%H%M%S}"
    most = None if asked.most_mb is None else round(asked.most_mb * MB)
    disk = Disk(folder, round(asked.max_size_mb * MB), round(asked.spare_mb * MB), most)
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
        from edgevox.ops.health_server import HealthServer

        server = HealthServer(health, settings.health_host, settings.health_port)
        stack.callback(server.close)
        server.start()


def _conclude(recorder: "Recorder", folder: Path, lost: list[str]) -> None:
    show(f"{recorder.written} messages in {recorder.files} files in {folder}")
    dropped = recorder.dropped
    if dropped or recorder.fault:
        most = ", ".join(f"{count} of {name}" for name, count in list(dropped.items())[:5])
        lost.append(f"not all was recorded: {recorder.fault or 'dropped ' + most}")
