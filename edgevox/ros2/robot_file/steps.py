"""What a step of a robot file may hold: one interface, what is sent to it, what comes back.

Which values an argument of a robot file may have; a default has to be one.
"""

import re
from collections.abc import Collection, Mapping, Sized
from math import isfinite
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    model_validator,
)
from pydantic_core import core_schema

from edgevox.core.files.validation import Place, wrong

LONGEST_WAIT_S = 86_400.0
LONGEST_STOP_S = 5.0
"""What is done after a stop may not keep the robot from the next one."""
MOST_A_SECOND = 50.0

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Word = Annotated[str, Field(min_length=1, max_length=100)]


class Written:
    """A text that matches a pattern; where it does not, `what` says what is expected."""

    def __init__(self, pattern: str, what: str) -> None:
        self._pattern, self._what = pattern, what

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "pattern": self._pattern}

    def _check(self, text: str) -> str:
        if re.fullmatch(self._pattern, text) is None:
            raise ValueError(self._what)
        return text


Name = Annotated[
    str,
    Written(
        r"^[a-z][a-z0-9_]{0,39}$",
        "a name of at most 40 lower-case letters, digits and underscores, such as raise_arm",
    ),
]
"""A name in the file: lower case, digits and underscores."""
GraphName = Annotated[
    str, Written(r"^~?/?[A-Za-z][A-Za-z0-9_/]{0,254}$", "a name on the graph such as arm/raise")
]
"""A topic, service or action; relative to the robot's namespace unless it begins with a slash."""


def _is_scalar(value: Any) -> Any:
    if isinstance(value, bool | int | str) or (isinstance(value, float) and isfinite(value)):
        return value
    raise ValueError("a number, a truth or a text")


def at_most(most: int, what: str) -> BeforeValidator:
    """So many keys of a mapping, which are counted before each is looked at."""

    def check(value: Any) -> Any:
        if isinstance(value, Sized) and len(value) > most:
            raise ValueError(f"at most {most} {what}, not {len(value)}")
        return value

    return BeforeValidator(check)


Scalar = Annotated[bool | int | float | str, BeforeValidator(_is_scalar)]
Meaning = Scalar | list[Any] | dict[str, Any]
"""What a word stands for in a request: a value, a list, or a message's fields by name."""


Request = (
    Mapping[str, Any]
    | Annotated[str, Written(r"^\{[a-z][a-z0-9_]*\}$", "fields, or an argument such as {spot}")]
)
"""What fills a message: its fields, or a choice whose words stand for these."""


class Part(BaseModel):
    """A mapping of the file; a key that nobody knows is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Interface(Part):
    """One interface of the robot: its name on the graph, and its type."""

    name: GraphName
    type: Word = Field(description="such as std_srvs/srv/SetBool")


class Topic(Interface):
    """A topic; `latched` is transient local: late subscribers get the last message."""

    latched: bool = False


class Publication(Topic):
    """A message to publish: once, or `rate_hz` times a second for `for_s` or until a stop."""

    rate_hz: Number = Field(0.0, ge=0.0, le=MOST_A_SECOND)
    for_s: Number = Field(0.0, ge=0.0, le=LONGEST_WAIT_S)
    at_end: Mapping[str, Any] | None = Field(
        None, description="published once at the end, even after a stop"
    )


class ResultValue(Part):
    """A value of the answer: the path of a field.

    A number is multiplied by `times`, then `plus` is added, and it is rounded. `count` is how many
    a list has.
    """

    field: Word
    times: Number | None = None
    plus: Number | None = None
    decimals: int = Field(3, ge=0, le=6)
    count: bool = False

    @property
    def converts(self) -> bool:
        """Whether it changes a number."""
        return self.times is not None or self.plus is not None


class Progress(ResultValue):
    """How much of an action is done, by a number of its feedback.

    The number is a part of `of`, a number or a field of the feedback; 1 by default. With `down` it
    counts down to 0, from `of` or else from its first value.
    """

    of: Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)] | Word | None = None
    down: bool = False


class ActionInterface(Interface):
    """An action; `progress` is the path of a number in the feedback that goes from 0 to 1.

    For another range, give `of`, `times` or `down`: ``{field: percent, of: 100}``. `tells` is the
    path of a text in the feedback, which the robot says when it is asked what it does.
    """

    progress: Word | Progress | None = None
    tells: Word | None = None

    @property
    def part_done(self) -> Progress | None:
        """Which value of the feedback says how much is done."""
        return Progress(field=self.progress) if isinstance(self.progress, str) else self.progress


class Comparison(Part):
    """What a value has to be: `equals`, or a number `above` or `below`."""

    equals: Scalar | None = None
    above: Number | None = None
    below: Number | None = None

    @model_validator(mode="after")
    def _says_something(self) -> "Comparison":
        if self.equals is None and self.above is None and self.below is None:
            raise wrong((), None, "equals, above or below")
        return self


class FieldCondition(Comparison):
    """A condition for a field of a message.

    `equals` may name arguments and earlier results, as requests do, and a constant of the message.
    """

    field: Word


class Wait(Topic):
    """Waits for a message on a topic that meets every condition."""

    until: Annotated[list[FieldCondition], Field(min_length=1, max_length=10)]


WAYS = ("publish", "call", "action", "read", "wait")


class Step(Part):
    """One step over ROS 2, in exactly one of these ways.

    `request` fills the message. `result` names values of the answer by the path of a field, for
    sentences and later steps. The step fails if a condition of `expect` is not met.
    """

    publish: Publication | None = None
    call: Interface | None = None
    action: ActionInterface | None = None
    read: Topic | None = None
    wait: Wait | None = None
    request: Request = Field(default_factory=dict)
    result: Mapping[Name, Word | ResultValue] = Field(default_factory=dict)
    expect: list[FieldCondition] = Field(default_factory=list, max_length=10)
    timeout_s: Number = Field(
        60.0, gt=0.0, le=LONGEST_WAIT_S, description="seconds after which it fails"
    )

    @property
    def ways(self) -> list[str]:
        """The ways that are given."""
        return [way for way in WAYS if getattr(self, way) is not None]

    @property
    def values(self) -> Mapping[str, ResultValue]:
        """The values of what comes back, by their names."""
        return {
            name: one if isinstance(one, ResultValue) else ResultValue(field=one)
            for name, one in self.result.items()
        }

    @property
    def conditions(self) -> list[FieldCondition]:
        """All that must hold of what comes."""
        return [*self.expect, *(self.wait.until if self.wait else ())]


class StopStep(Step):
    """The step that runs at once when a skill is stopped: a message or a call, within seconds."""

    timeout_s: Number = Field(
        2.0, gt=0.0, le=LONGEST_STOP_S, description="seconds after which it fails"
    )

    @model_validator(mode="after")
    def _is_short(self) -> "StopStep":
        one_way(self, ())
        if not (self.call or (self.publish and not self.publish.rate_hz)):
            expected = "publish without rate_hz, or call: what is stopped may not begin anew"
            raise wrong((self.ways[0],), None, expected)
        return self


def one_way(step: Step, place: Place) -> None:
    """Raise unless it is done in exactly one way."""
    if len(step.ways) != 1:
        raise wrong(place, step.ways, "exactly one of " + ", ".join(WAYS))


_KINDS = {"boolean": "true or false", "text": "a text", "integer": "a whole number"}


def wanted_instead(
    value: Scalar, kind: str, words: Collection[str], low: float | None, high: float | None
) -> str:
    """What an argument of this kind would take instead of a value; empty if it takes it."""
    if kind == "choice":
        return "" if value in words else "one of " + ", ".join(words)
    within = not isinstance(value, bool | str) and (
        (low is None or value >= low) and (high is None or value <= high)
    )
    fits = {
        "boolean": isinstance(value, bool),
        "text": isinstance(value, str),
        "integer": within and isinstance(value, int),
        "number": within,
    }
    if fits[kind]:
        return ""
    bounds = [f"{word} {one:g}" for word, one in (("from", low), ("to", high)) if one is not None]
    return " ".join([_KINDS.get(kind, "a number"), *bounds])
