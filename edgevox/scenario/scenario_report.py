"""What a person reads of a scenario: a line a step, and why the last one failed."""

from edgevox.core.text import one_line
from edgevox.scenario.run_scenario import StepResult
from edgevox.scenario.scenario import Scenario


def heading(scenario: Scenario, file: str, robot: str) -> str:
    """What is played, by whom."""
    return one_line(f"{file} on {robot}" + (f": {scenario.about}" if scenario.about else ""))


def line(outcome: StepResult) -> str:
    """A step: how it went, when it was done by the robot's time and by the machine's, what it was.

    Below it, why it failed.
    """
    verdict = "PASS" if outcome.passed else "FAIL"
    times = f"{outcome.time_s:9.2f} s {outcome.real_s:8.2f} s real"
    said = f"{verdict} {outcome.number:3} {times}  {outcome.step}"
    return "\n".join(map(one_line, [said, *(f"{'':36}{why}" for why in outcome.why)]))


def summary(scenario: Scenario, last: StepResult | None) -> str:
    """The verdict."""
    done, of = (last.number if last else 0), len(scenario.steps)
    if last is None or not last.passed:
        return f"FAILED at step {done} of {of}"
    return f"PASSED {of} steps, {last.time_s:.2f} s of the robot's time in {last.real_s:.2f} s"
