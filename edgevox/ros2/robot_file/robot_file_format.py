"""What a robot file may hold: a robot, its limits and places, and the skills it has.

namespace: /cleaner
skills:
  clean_room:
    description: Clean a room.
    action: {name: clean, type: cleaner_msgs/action/Clean}
    request: {room: "{room}", passes: "{passes}"}

Arguments:
      room: {type: choice, values: [hall, office]}
      passes: {type: integer, min: 1, max: 3, default: 1}
    sentences: ["clean [the] {room} [{passes} times]"]
    says: Cleaning the {room}.
    done: The {room} is clean.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from edgevox.core.languages import LANGUAGES
from edgevox.core.validation import wrong

MOST_SKILLS = 100
MOST_STEPS = 20
LONGEST_WAIT_S = 86_400.0
MOST_A_SECOND = 50.0

Number = Annotated[float, Field(allow_inf_nan=False)]
Word = Annotated[str, Field(min_length=1, max_length=100)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
"""A name in the file: lower case, digits and underscores."""
GraphName = Annotated[str, Field(pattern=r"^~?/?[A-Za-z][A-Za-z0-9_/]{0,254}$")]
"""A topic, service or action; relative to the robot's namespace unless it begins with a slash."""
Scalar = bool | int | Number | str
Meaning = Scalar | list[Any] | dict[str, Any]
"""What a word stands for in a request: a value, a list, or a message's fields by name."""


class Part(BaseModel):
    """A mapping of the file; a key that nobody knows is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Interface(Part):
    """One interface of the robot: its name on the graph, and its type."""

    name: GraphName
    type: Word = Field(description="such as std_srvs/srv/SetBool")


class Topic(Interface):
    """A topic; `latched` is transient local: what was said last is kept for who comes later."""

    latched: bool = False


class Publication(Topic):
    """What is published: once, or `rate_hz` times a second for `for_s`, or until it is stopped."""

    rate_hz: float = Field(0.0, ge=0.0, le=MOST_A_SECOND)
    for_s: float = Field(0.0, ge=0.0, le=LONGEST_WAIT_S)
    at_end: Mapping[str, Any] | None = Field(
        None, description="published once when it is over, also when it was stopped"
    )


class ActionInterface(Interface):
    """An action; `progress` is the path of a feedback's field that goes from 0 to 1."""

    progress: Word | None = None


class ResultValue(Part):
    """A value of what comes back: a field by its path, a number in it `times` so much, rounded."""

    field: Word
    times: Number | None = None
    decimals: int = Field(3, ge=0, le=6)


class FieldCondition(Part):
    """What a field of a message must be: `equals`, or a number `above` or `below`.

    `equals` may name arguments and earlier results, as requests do.
    """

    field: Word
    equals: Scalar | None = None
    above: Number | None = None
    below: Number | None = None

    @model_validator(mode="after")
    def _says_something(self) -> "FieldCondition":
        if self.equals is None and self.above is None and self.below is None:
            raise wrong((), None, "equals, above or below")
        return self


class Wait(Topic):
    """Waits for a message on a topic for which every condition holds."""

    until: Annotated[list[FieldCondition], Field(min_length=1, max_length=10)]


WAYS = ("publish", "call", "action", "read", "wait")


class Step(Part):
    """One thing that is done over ROS 2, in exactly one of these ways.

    `request` fills the message; `result` are values of what comes back, by the path of a field,
    which sentences and later steps may use; `expect` are conditions without which it has failed.
    """

    publish: Publication | None = None
    call: Interface | None = None
    action: ActionInterface | None = None
    read: Topic | None = None
    wait: Wait | None = None
    request: Mapping[str, Any] = Field(default_factory=dict)
    result: Mapping[Name, Word | ResultValue] = Field(default_factory=dict)
    expect: list[FieldCondition] = Field(default_factory=list, max_length=10)
    timeout_s: float = Field(
        60.0, gt=0.0, le=LONGEST_WAIT_S, description="longer, and it has failed"
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


class Argument(Part):
    """What a skill is told: a number, a whole number, a truth, a text, or one of some words.

    `values` of a choice are its words, or what each word stands for in the request; `aliases` are
    other things people say for a word, in any language. A number goes into the request `times` so
    much: 0.01 where people say percent and the robot takes a part of one.
    """

    type: Literal["number", "integer", "boolean", "text", "choice"]
    description: str = ""
    unit: str = ""
    min: Number | None = None
    max: Number | None = None
    default: Scalar | None = None
    times: Number | None = None
    values: list[Word] | dict[Word, Meaning] | None = None
    aliases: Mapping[Word, Word] = Field(default_factory=dict)

    @property
    def meanings(self) -> Mapping[str, Meaning]:
        """What each word of a choice stands for."""
        values = self.values or []
        return values if isinstance(values, dict) else {word: word for word in values}

    @model_validator(mode="after")
    def _fits_its_type(self) -> "Argument":
        if (self.type == "choice") != bool(self.values):
            raise wrong(("values",), self.values, "words, for a choice and for nothing else")
        for said, word in self.aliases.items():
            if word not in self.meanings:
                raise wrong(("aliases", said), word, "one of " + ", ".join(self.meanings))
        for name in ("min", "max", "times"):
            if getattr(self, name) is not None and self.type not in ("number", "integer"):
                raise wrong((name,), getattr(self, name), "nothing: this is for numbers only")
        return self


class Sentences(Part):
    """What is said to have it done, and what the robot says of it, in one language."""

    sentences: list[Word] = Field(default_factory=list, max_length=50)
    says: str = ""
    done: str = ""
    failed: str = ""
    can: str = Field("", description="what the robot can do, as a part of a sentence")


def _known_languages(by_code: dict[str, Sentences]) -> dict[str, Sentences]:
    for code in by_code:
        if code not in LANGUAGES or code == "en":
            raise wrong((code,), code, "a code of " + ", ".join(sorted(set(LANGUAGES) - {"en"})))
    return by_code


class SkillEntry(Step, Sentences):
    """A skill: one step of its own, or a list of `steps`, which are done in order.

    `moves`: it uses the body, so it ends whatever moves, and every stop ends it; by default all
    that does more than read. `stop` is done when it was stopped, beside the cancel of an action.
    """

    description: Word
    arguments: Mapping[Name, Argument] = Field(default_factory=dict)
    steps: list[Step] = Field(default_factory=list, max_length=MOST_STEPS)
    stop: Step | None = None
    moves: bool | None = None
    languages: Annotated[dict[str, Sentences], AfterValidator(_known_languages)] = Field(
        default_factory=dict
    )

    @property
    def every_step(self) -> list[Step]:
        """What it does, in order."""
        return self.steps or [self]

    @property
    def uses_the_body(self) -> bool:
        """Whether it moves, as it says, or because it does more than read."""
        reads = all(step.read for step in self.every_step)
        return not reads if self.moves is None else self.moves

    @model_validator(mode="after")
    def _each_step_has_one_way(self) -> "SkillEntry":
        if self.steps and self.ways:
            raise wrong((self.ways[0],), None, "nothing: the skill has steps")
        for index, step in enumerate(self.steps):
            _one_way(step, ("steps", index))
        if self.stop:
            _one_way(self.stop, ("stop",))
        if not self.steps:
            _one_way(self, ())
        if self.moves is False and not all(step.read for step in self.every_step):
            _only_short(self)
        return self


def _one_way(step: Step, place: tuple[str | int, ...]) -> None:
    if len(step.ways) != 1:
        raise wrong(place, step.ways, "exactly one of " + ", ".join(WAYS))


def _only_short(entry: SkillEntry) -> None:
    for step in entry.every_step:
        if step.wait or step.action or (step.publish and step.publish.rate_hz):
            expected = "true: what takes its time is a goal that a stop can end"
            raise wrong(("moves",), False, expected)


class Limits(Part):
    """How fast it is steered where nothing there takes goals, in m/s and rad/s."""

    max_linear: float | None = Field(None, gt=0.0, le=10.0)
    max_angular: float | None = Field(None, gt=0.0, le=10.0)


class RobotFile(Part):
    """A whole file. What it says of the robot counts unless a setting says otherwise.

    `topics` are what the robot calls the topics of the contract: ``{odom: wheel/odometry}``;
    `locations` is a file of places, beside this one.
    """

    description: str = ""
    namespace: str = Field("/", pattern=r"^/([A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*)?$")
    topics: Mapping[
        Literal["odom", "cmd_vel", "goal_pose", "scan", "map", "camera/image_raw"], GraphName
    ] = Field(default_factory=dict)
    limits: Limits = Limits()
    locations: Path | None = None
    skills: Annotated[Mapping[Name, SkillEntry], Field(max_length=MOST_SKILLS)] = Field(
        default_factory=dict
    )
