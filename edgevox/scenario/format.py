"""The format of a scenario file: its steps, its conditions, and comparisons with what is seen.

Validation guesses nothing and leaves nothing out; an error names the field and the line.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import is_number
from edgevox.core.files.yaml_file import YamlFile


class Missing:
    """What is found where a path leads nowhere: it is not even null."""

    def __repr__(self) -> str:
        return "missing"


MISSING = Missing()
_ROUNDING = 1e-9
_LISTS = (list, tuple)

Number = Annotated[float, Field(allow_inf_nan=False)]
Text = Annotated[str, Field(min_length=1, max_length=500)]


def _pattern(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise ValueError(f"a regular expression ({error})") from None
    return text


class Compare(BaseModel):
    """Comparisons with one value, which must all be true. A plain value means `equals`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    equals: Any = Field(None, description="the same value")
    differs: Any = Field(None, description="any other value")
    near: Number | tuple[Number, ...] | None = Field(
        None, description="a number, or a list of them, within `by` of each"
    )
    by: Annotated[Number, Field(ge=0)] | None = Field(
        None, description="largest distance from `near`"
    )
    above: Number | None = Field(None, description="a number larger than this")
    below: Number | None = Field(None, description="a number smaller than this")
    contains: Text | None = Field(
        None, description="a text with this in it, in any case, or a list or object with this entry"
    )
    matches: Annotated[Text, AfterValidator(_pattern)] | None = Field(
        None, description="a text in which this regular expression is found"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not self.model_fields_set:
            raise ValueError("at least one of " + ", ".join(Compare.model_fields))
        if (self.near is None) != (self.by is None):
            raise ValueError("near and by together")
        return self

    def holds(self, value: Any) -> bool:
        """Whether all of it is true of this value."""
        return all(_TESTS[name](self, value) for name in self.model_fields_set if name != "by")

    def __str__(self) -> str:
        given = [name for name in _SAYS if name in self.model_fields_set]
        return " and ".join(_SAYS[name](self) for name in given)


def _near(compare: Compare, value: Any) -> bool:
    if not isinstance(compare.near, tuple):
        return _close(value, compare.near, compare.by)
    if not isinstance(value, _LISTS) or len(value) != len(compare.near):
        return False
    return all(_close(one, to, compare.by) for one, to in zip(value, compare.near, strict=True))


def _close(value: Any, to: float | None, by: float | None) -> bool:
    return (
        is_number(value) and to is not None and by is not None and abs(value - to) <= by + _ROUNDING
    )


def _contains(compare: Compare, value: Any) -> bool:
    wanted = compare.contains or ""
    if isinstance(value, str):
        return wanted.casefold() in value.casefold()
    return isinstance(value, (*_LISTS, Mapping)) and wanted in value


_SAYS: Mapping[str, Callable[[Compare], str]] = {
    "equals": lambda compare: f"= {compare.equals!r}",
    "differs": lambda compare: f"not {compare.differs!r}",
    "near": lambda compare: f"= {compare.near} ± {compare.by:g}",
    "above": lambda compare: f"> {compare.above:g}",
    "below": lambda compare: f"< {compare.below:g}",
    "contains": lambda compare: f"with {compare.contains!r}",
    "matches": lambda compare: f"like {compare.matches!r}",
}
_TESTS: Mapping[str, Callable[[Compare, Any], bool]] = {
    "equals": lambda compare, value: value == compare.equals,
    "differs": lambda compare, value: value != compare.differs,
    "near": _near,
    "above": lambda compare, value: is_number(value) and value > compare.above,
    "below": lambda compare, value: is_number(value) and value < compare.below,
    "contains": _contains,
    "matches": lambda compare, value: (
        isinstance(value, str) and re.search(str(compare.matches), value) is not None
    ),
}


def _equals_if_plain(value: Any) -> Any:
    return value if isinstance(value, Mapping) else {"equals": value}


def _contains_if_plain(value: Any) -> Any:
    return {"contains": value} if isinstance(value, str) else value


_Plain = str | float | bool | list[Any] | None

Value = Annotated[
    Compare, BeforeValidator(_equals_if_plain, json_schema_input_type=Compare | _Plain)
]
"""A comparison, or a plain value that must be equal."""
Words = Annotated[
    Compare, BeforeValidator(_contains_if_plain, json_schema_input_type=Compare | str)
]
"""A comparison of a text, or a plain text that must be in it."""


def look_up(path: str, data: Mapping[str, Any]) -> Any:
    """The value at a path such as ``pose.x`` or ``cubes.0.name``, or `MISSING`."""
    value: Any = data
    for part in path.split("."):
        if isinstance(value, Mapping) and part in value:
            value = value[part]
        elif isinstance(value, _LISTS) and part.isdecimal() and int(part) < len(value):
            value = value[int(part)]
        else:
            return MISSING
    return value


FieldPath = Annotated[str, Field(pattern=r"^[\w-]+(\.[\w-]+)*$", max_length=200)]


class Strict(BaseModel):
    """A part of a scenario file: nothing in it that is not known, and it stays as it is."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class Condition(Strict):
    """Conditions for the robot. Several parts must all come true, but not at the same moment."""

    state: Annotated[dict[FieldPath, Value], Field(min_length=1, max_length=50)] | None = Field(
        None, description="values of robot_state by their paths, all at one moment"
    )
    answer: Words | None = Field(None, description="an answer since the last stimulus")
    event: Annotated[dict[FieldPath, Value], Field(min_length=1, max_length=50)] | None = Field(
        None, description="values of one agent_event since the last stimulus"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not self.model_fields_set:
            raise ValueError("at least one of state, answer, event")
        return self

    def __str__(self) -> str:
        parts = [f"{path} {wanted}" for path, wanted in (self.state or {}).items()]
        if self.answer:
            parts.append(f"answer {self.answer}")
        if self.event:
            inner = ", ".join(f"{path} {wanted}" for path, wanted in self.event.items())
            parts.append(f"event with {inner}")
        return ", ".join(parts)


class Never(Condition):
    """A condition that must never come true; one part only."""

    @model_validator(mode="after")
    def _one_part(self) -> Self:
        if len(self.model_fields_set) != 1:
            raise ValueError("only one of state, answer, event; write the others as more entries")
        return self


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
    """A stream of one velocity in m/s and rad/s, for seconds of the robot's time."""

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
    """Wait for seconds of the robot's time."""

    wait: Seconds

    def __str__(self) -> str:
        return f"wait {self.wait:g} s"


class ExpectStep(Strict):
    """Conditions and their deadline, in seconds of the robot's time from here."""

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
    """A scenario file."""

    about: str = Field("", max_length=500, description="its purpose, in a sentence")
    agent: Annotated[
        tuple[str, ...], BeforeValidator(_listed, json_schema_input_type=str | list[str])
    ] = Field((), description="the robots that can play it; default: any")
    settings: Annotated[dict[str, str | int | float], AfterValidator(_settable)] = Field(
        default_factory=dict, description="settings to run it with: " + ", ".join(SETTABLE)
    )
    limit_s: Annotated[float, Field(gt=0, le=LONGEST_RUN_S)] = Field(
        300.0, description="real seconds after which it fails, whatever the robot's time says"
    )
    never: Annotated[tuple[Never, ...], Field(max_length=50)] = Field(
        (), description="conditions that must never come true"
    )
    steps: Annotated[tuple[Step, ...], Field(min_length=1, max_length=MAX_STEPS)] = Field(
        description="the steps, in order"
    )


def load_scenario(file: Path) -> Scenario:
    """The scenario in a file. Raises `InvalidValue` naming the field, its line, what is wrong."""
    return parse_scenario(read_text(file, "scenario"), file.name)


def parse_scenario(text: str, name: str) -> Scenario:
    """As `load_scenario`; `name` is the file's name in messages."""
    file = YamlFile(text, name, tags=STEPS)
    if file.data is not None and not isinstance(file.data, dict):
        raise InvalidValue(name, file.data, "a mapping with steps")
    return file.read(Scenario, file.data)
