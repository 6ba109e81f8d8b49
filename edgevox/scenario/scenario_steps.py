"""What can happen in a scenario, one kind of step a class."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from edgevox.scenario.conditions import Condition, Strict

LONGEST_S = 3600.0

Seconds = Annotated[float, Field(ge=0, le=LONGEST_S)]
Speed = Annotated[float, Field(ge=-10, le=10)]


class SayStep(Strict):
    """Words for the agent, as if spoken and understood."""

    say: str = Field(min_length=1, max_length=2000)

    def __str__(self) -> str:
        return f"say {self.say!r}"


class InterruptStep(Strict):
    """Stop talking, thinking and moving."""

    interrupt: Literal[True]

    def __str__(self) -> str:
        return "interrupt"


class RunStep(Strict):
    """Run a skill, as a program would over ROS 2: without words."""

    run: str = Field(min_length=1, max_length=100)
    arguments: dict[str, Any] = Field(default_factory=dict, alias="with", max_length=50)

    def __str__(self) -> str:
        return f"run {self.run}({', '.join(f'{k}={v!r}' for k, v in self.arguments.items())})"


class Velocity(Strict):
    """A stream of one velocity: m/s, rad/s, for some seconds of the robot's time."""

    linear: Speed = 0.0
    angular: Speed = 0.0
    seconds: Seconds


class DriveStep(Strict):
    """Steer by hand, as `cmd_vel` does."""

    drive: Velocity

    def __str__(self) -> str:
        v = self.drive
        return f"drive at {v.linear:g} m/s and {v.angular:g} rad/s for {v.seconds:g} s"


class WaitStep(Strict):
    """Let seconds of the robot's time pass."""

    wait: Seconds

    def __str__(self) -> str:
        return f"wait {self.wait:g} s"


class ExpectStep(Strict):
    """What must be true by when, in seconds of the robot's time from here."""

    expect: Condition
    within: Seconds = 0.0

    def __str__(self) -> str:
        return f"expect {self.expect}" + (f" within {self.within:g} s" if self.within else "")


STEPS: Mapping[str, type[Strict]] = {
    "say": SayStep,
    "interrupt": InterruptStep,
    "run": RunStep,
    "drive": DriveStep,
    "wait": WaitStep,
    "expect": ExpectStep,
}
"""What a step can be, by the key that makes it so."""


def _kind(step: Any) -> str | None:
    known = type(step).model_fields if isinstance(step, Strict) else step
    keys = known if isinstance(known, Mapping) else ()
    return next((key for key in STEPS if key in keys), None)


Step = Annotated[
    Annotated[SayStep, Tag("say")]
    | Annotated[InterruptStep, Tag("interrupt")]
    | Annotated[RunStep, Tag("run")]
    | Annotated[DriveStep, Tag("drive")]
    | Annotated[WaitStep, Tag("wait")]
    | Annotated[ExpectStep, Tag("expect")],
    Discriminator(
        _kind,
        custom_error_type="step",
        custom_error_message="a step with one of " + ", ".join(STEPS),
    ),
]
