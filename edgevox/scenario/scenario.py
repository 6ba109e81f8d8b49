"""The format of a scenario file, validated: nothing in it is guessed, nothing is left out."""

from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

from edgevox.scenario.conditions import Never, Strict
from edgevox.scenario.scenario_steps import Step

MAX_STEPS = 1000
LONGEST_RUN_S = 24 * 3600.0
SETTABLE = (
    "language",
    "voice",
    "llm",
    "llm_backend",
    "seed",
    "world",
    "model_source",
    "mjcf",
    "locations",
    "policy",
)
"""The settings that a scenario may make: those that change what happens, none of the machine's."""


def _settable(settings: dict[str, str | int | float]) -> dict[str, str | int | float]:
    for name in settings:
        if name not in SETTABLE:
            raise ValueError("only " + ", ".join(SETTABLE))
    return settings


def _listed(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


class Scenario(Strict):
    """A whole file."""

    about: str = Field("", max_length=500, description="what it shows, in a sentence")
    agent: Annotated[
        tuple[str, ...], BeforeValidator(_listed, json_schema_input_type=str | list[str])
    ] = Field((), description="the robots that it is for; any without")
    settings: Annotated[dict[str, str | int | float], AfterValidator(_settable)] = Field(
        default_factory=dict, description="settings to run it with: " + ", ".join(SETTABLE)
    )
    limit_s: Annotated[float, Field(gt=0, le=LONGEST_RUN_S)] = Field(
        300.0, description="real seconds after which it has failed, whatever the robot's time says"
    )
    never: Annotated[tuple[Never, ...], Field(max_length=50)] = Field(
        (), description="what must not come true at any moment"
    )
    steps: Annotated[tuple[Step, ...], Field(min_length=1, max_length=MAX_STEPS)] = Field(
        description="what happens, in order"
    )
