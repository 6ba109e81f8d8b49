"""Plays a scenario file with a whole agent and tells how it went."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from edgevox.apps.composition import build_parts, start_parts
from edgevox.apps.conversation_harness import ConversationHarness
from edgevox.apps.snapshot import check_picture, write_picture
from edgevox.apps.streams import show
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import NO_LLM, Settings
from edgevox.robots.capabilities import Body
from edgevox.scenario import Scenario, load_scenario, run_scenario
from edgevox.scenario.run_scenario import StepResult
from edgevox.scenario.scenario_report import heading, line, summary

REST_S = 30.0
"""How much of the robot's time it may take to come to rest at the end."""


@dataclass(frozen=True)
class Script:
    """A scenario and the file it is from."""

    file: Path
    scenario: Scenario

    def flags(self, given: dict[str, Any]) -> dict[str, Any]:
        """What to load: what was given overrules the scenario; in text, no model unless named."""
        own = dict(self.scenario.settings)
        for name in ("world", "mjcf", "locations", "policy"):
            if name in own:
                own[name] = str(self.file.parent / str(own[name]))
        return {"llm": NO_LLM, "text_mode": True, **own, **given}


def read_script(file: Path, robot: str) -> Script:
    """Read the file. Raises `InvalidValue` for what is wrong in it, or for another robot."""
    scenario = load_scenario(file)
    if scenario.agent and robot not in scenario.agent:
        raise InvalidValue(f"{file.name}: agent", robot, "one of " + ", ".join(scenario.agent))
    return Script(file, scenario)


def play(
    script: Script,
    settings: Settings,
    body: Body,
    *,
    snapshot: Path | None = None,
    ros_args: Sequence[str] = (),
) -> bool:
    """Play it from start to end, with the report on stdout; whether all came true."""
    shown = check_picture(body, snapshot) if snapshot else None
    last: list[StepResult] = []

    def tell(outcome: StepResult) -> None:
        last[:] = [outcome]
        _write(line(outcome))

    with ExitStack() as stack:
        parts = build_parts(stack, settings, body)
        harness = ConversationHarness(parts.bus, parts.conversation, body, parts.guard)
        stack.callback(harness.close)
        start_parts(stack, parts, ros_args)
        _write(heading(script.scenario, script.file.name, body.name))
        stack.callback(harness.come_to_rest, REST_S)
        passed = run_scenario(script.scenario, harness, tell)
        if shown and snapshot:
            write_picture(shown, snapshot)
    _write(summary(script.scenario, last[0] if last else None))
    return passed


def _write(text: str) -> None:
    show(text)
