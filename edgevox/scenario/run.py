"""Plays a scenario, step by step, up to the first that fails.

Where a scenario plays: what its runner needs of it.

What a person reads of a scenario: a line a step, and why the last one failed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.files.text import one_line
from edgevox.scenario.format import (
    DriveStep,
    ExpectStep,
    InterruptStep,
    RunStep,
    SayStep,
    Scenario,
    Step,
    WaitStep,
)
from edgevox.scenario.judge import Judge, Seen, Source, describe


class Harness(Protocol):
    """A robot that is given stimuli and watched. Stimuli raise `EdgeVoxError` if refused."""

    @property
    def time_s(self) -> float:
        """The robot's time."""

    def say(self, text: str, timeout_s: float) -> None:
        """Say it, and wait until it is answered or the timeout is over; goals may still run."""

    def interrupt(self, timeout_s: float) -> None:
        """Stop everything."""

    def run(self, skill: str, arguments: Mapping[str, Any]) -> None:
        """Start a skill."""

    def steer(self, linear_m_s: float, angular_rad_s: float) -> None:
        """One velocity of a stream."""

    def let_pass(self, seconds: float) -> Sequence[Seen]:
        """Let time pass; what was seen in it."""

    def look(self) -> Sequence[Seen]:
        """What was seen since the last time."""


MOMENT_S = 0.05
"""How finely the robot's time is cut: conditions are looked at this often."""
STREAM_S = 0.1
"""How often a velocity of a stream is sent."""
_NOTHING_S = 1e-6


@dataclass(frozen=True, slots=True)
class StepResult:
    """How one step went; times since the start, of the robot and of the machine."""

    number: int
    step: Step
    passed: bool
    time_s: float
    real_s: float
    why: tuple[str, ...] = ()


class _Failed(Exception):
    """The step has failed; the lines say why."""

    def __init__(self, *lines: str) -> None:
        super().__init__(*lines)
        self.lines = lines


def run_scenario(
    scenario: Scenario,
    harness: Harness,
    tell: Callable[[StepResult], None],
    clock: Clock | None = None,
) -> bool:
    """Play it; whether all came true. `tell` hears of every step as it is done."""
    return _Play(scenario, harness, clock or SystemClock()).run(tell)


class _Play:
    def __init__(self, scenario: Scenario, harness: Harness, clock: Clock) -> None:
        self._scenario, self._harness, self._clock = scenario, harness, clock
        self._judge = Judge(scenario.never)
        self._started_s = clock.now()
        self._robot_started_s = harness.time_s

    def run(self, tell: Callable[[StepResult], None]) -> bool:
        last = len(self._scenario.steps)
        for number, step in enumerate(self._scenario.steps, 1):
            why = self._why_failed(step, last=number == last)
            time_s = self._harness.time_s - self._robot_started_s
            tell(StepResult(number, step, not why, time_s, self._real_s, why))
            if why:
                return False
        return True

    def _why_failed(self, step: Step, *, last: bool) -> tuple[str, ...]:
        """Empty if it did not."""
        try:
            self._look()
            self._do(step)
            self._look()
            if last and self._judge.never_looked:
                paths = ", ".join(self._judge.never_looked)
                return (f"never could not be judged: robot_state has no {paths}",)
        except _Failed as failure:
            return failure.lines
        except EdgeVoxError as error:
            return (str(error),)
        return ()

    def _do(self, step: Step) -> None:
        if not isinstance(step, ExpectStep | WaitStep):
            self._judge.stimulus()
        match step:
            case SayStep(say=text):
                self._harness.say(text, self._left_s)
            case InterruptStep():
                self._harness.interrupt(self._left_s)
            case RunStep(run=skill, arguments=arguments):
                self._harness.run(skill, arguments)
            case DriveStep():
                self._drive(step)
            case WaitStep(wait=seconds):
                self._pass(self._harness.time_s + seconds)
            case ExpectStep():
                self._expect(step)

    def _drive(self, step: DriveStep) -> None:
        until_s = self._harness.time_s + step.drive.seconds
        while self._harness.time_s < until_s - _NOTHING_S:
            self._harness.steer(step.drive.linear, step.drive.angular)
            self._pass(min(until_s, self._harness.time_s + STREAM_S))

    def _expect(self, step: ExpectStep) -> None:
        watch = self._judge.expect(step.expect, self._harness.time_s, step.within)
        while not watch.met:
            if self._harness.time_s >= watch.deadline_s - _NOTHING_S:
                raise _Failed(*watch.explain())
            try:
                self._moment(watch.deadline_s)
            except _Failed as failure:
                raise _Failed(*failure.lines, *watch.explain()) from None

    def _pass(self, until_s: float) -> None:
        while self._harness.time_s < until_s - _NOTHING_S:
            self._moment(until_s)

    def _moment(self, until_s: float) -> None:
        """Let a moment pass, not beyond `until_s`."""
        for seen in self._harness.let_pass(min(MOMENT_S, until_s - self._harness.time_s)):
            self._judge.see(seen)
        self._check()

    def _look(self) -> None:
        for seen in self._harness.look():
            self._judge.see(seen)
        self._check()

    def _check(self) -> None:
        if self._judge.broken:
            never, seen = self._judge.broken
            what = describe(never, Source(seen.source), seen)
            raise _Failed(f"expected never {never}", f"seen: {what}")
        if self._left_s <= 0.0:
            raise _Failed(f"it took longer than the limit of {self._scenario.limit_s:g} real s")

    @property
    def _real_s(self) -> float:
        return self._clock.now() - self._started_s

    @property
    def _left_s(self) -> float:
        return max(0.0, self._scenario.limit_s - self._real_s)


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
