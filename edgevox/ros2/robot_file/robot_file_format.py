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

from edgevox.agent.policy import PolicyFile
from edgevox.core.languages import LANGUAGES
from edgevox.core.validation import wrong
from edgevox.robots.names_per_language import LocalNames, check_told_apart
from edgevox.ros2.external.locations import LocationsFile

MOST_SKILLS = 100
MOST_STEPS = 20
LONGEST_WAIT_S = 86_400.0
LONGEST_STOP_S = 5.0
"""What is done after a stop may not keep the robot from the next one."""
MOST_WATCHES = 5
MOST_A_SECOND = 50.0

Number = Annotated[float, Field(allow_inf_nan=False)]
Word = Annotated[str, Field(min_length=1, max_length=100)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
"""A name in the file: lower case, digits and underscores."""
GraphName = Annotated[str, Field(pattern=r"^~?/?[A-Za-z][A-Za-z0-9_/]{0,254}$")]
"""A topic, service or action; relative to the robot's namespace unless it begins with a slash."""
Scalar = bool | int | Number | str


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


class FieldCondition(Part):
    """What a field of a message must be: `equals`, or a number `above` or `below`."""

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
    """A message on a topic for which every condition holds."""

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
    result: Mapping[Name, Word] = Field(default_factory=dict)
    expect: list[FieldCondition] = Field(default_factory=list, max_length=10)
    timeout_s: float = Field(
        60.0, gt=0.0, le=LONGEST_WAIT_S, description="longer, and it has failed"
    )

    @property
    def ways(self) -> list[str]:
        """The ways that are given."""
        return [way for way in WAYS if getattr(self, way) is not None]


class StopStep(Step):
    """What is done at once when a skill was stopped: a message or a call, within seconds."""

    timeout_s: float = Field(
        2.0, gt=0.0, le=LONGEST_STOP_S, description="longer, and it has failed"
    )

    @model_validator(mode="after")
    def _is_short(self) -> "StopStep":
        _one_way(self, ())
        if not (self.call or (self.publish and not self.publish.rate_hz)):
            expected = "publish without rate_hz, or call: what is stopped may not begin anew"
            raise wrong((self.ways[0],), None, expected)
        return self


class Argument(Part):
    """What a skill is told: a number, a whole number, a truth, a text, or one of some words.

    `values` of a choice are its words, or what each word stands for in the request; `aliases` are
    other things people say for a word, in any language; `names` are what a word is called in each.
    """

    type: Literal["number", "integer", "boolean", "text", "choice"]
    description: str = ""
    unit: str = ""
    min: Number | None = None
    max: Number | None = None
    default: Scalar | None = None
    values: list[Word] | dict[Word, Scalar] | None = None
    aliases: Mapping[Word, Word] = Field(default_factory=dict)
    names: Mapping[Word, LocalNames] = Field(default_factory=dict)

    @property
    def meanings(self) -> Mapping[str, Scalar]:
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
        _told_apart(self)
        for name in ("min", "max"):
            if getattr(self, name) is not None and self.type not in ("number", "integer"):
                raise wrong((name,), getattr(self, name), "nothing: only numbers have bounds")
        return self


def _told_apart(one: Argument) -> None:
    for word in one.names:
        if word not in one.meanings:
            raise wrong(("names", word), word, "one of " + ", ".join(one.meanings))
    aliases = {
        word: tuple(said for said, meant in one.aliases.items() if meant == word)
        for word in one.meanings
    }
    entries = {word: (aliases[word], one.names.get(word, {})) for word in aliases}
    check_told_apart(entries, lambda word, code: ("names", word, code))


class Sentences(Part):
    """What is said to have it done, and what the robot says of it, in one language."""

    sentences: list[Word] = Field(default_factory=list, max_length=50)
    says: str = ""
    done: str = ""
    failed: str = ""
    can: str = Field("", description="what the robot can do, as a part of a sentence")
    argument_names: Mapping[Name, Word] = Field(
        default_factory=dict, description="what arguments are called: the number of passes"
    )
    asks: str = Field("", description="the end of a question that begins 'Shall I'")


def _known_languages(by_code: dict[str, Sentences]) -> dict[str, Sentences]:
    for code in by_code:
        if code not in LANGUAGES or code == "en":
            raise wrong((code,), code, "a code of " + ", ".join(sorted(set(LANGUAGES) - {"en"})))
    return by_code


class SkillEntry(Step, Sentences):
    """A skill: one step of its own, or a list of `steps`, which are done in order.

    `moves`: it uses the body, so it ends whatever moves, and every stop ends it; by default all
    that does more than read. `confirm`: somebody has to say yes before it is begun. `stops_on` are
    messages that end it, and with which it does not begin. `stop` is done when it did not come to
    its end, beside the cancel of an action.
    """

    description: Word
    arguments: Mapping[Name, Argument] = Field(default_factory=dict)
    steps: list[Step] = Field(default_factory=list, max_length=MOST_STEPS)
    stop: StopStep | None = None
    stops_on: list[Wait] = Field(default_factory=list, max_length=MOST_WATCHES)
    moves: bool | None = None
    confirm: bool = False
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
        if not self.steps:
            _one_way(self, ())
        if self.moves is False and not all(step.read for step in self.every_step):
            _only_short(self)
        _only_arguments(self, (), self.arguments)
        for code, said in self.languages.items():
            _only_arguments(said, ("languages", code), self.arguments)
        return self


def _one_way(step: Step, place: tuple[str | int, ...]) -> None:
    if len(step.ways) != 1:
        raise wrong(place, step.ways, "exactly one of " + ", ".join(WAYS))


def _only_arguments(
    said: Sentences, place: tuple[str, ...], arguments: Mapping[str, Argument]
) -> None:
    for name in said.argument_names:
        if name not in arguments:
            known = "an argument: one of " + (", ".join(arguments) or "none")
            raise wrong((*place, "argument_names", name), name, known)


def _only_short(entry: SkillEntry) -> None:
    for step in entry.every_step:
        if step.wait or step.action or (step.publish and step.publish.rate_hz):
            expected = "true: what takes its time is a goal that a stop can end"
            raise wrong(("moves",), False, expected)


class Limits(Part):
    """How it is steered where nothing there takes goals, in m/s, rad/s and m/s²."""

    max_linear: float | None = Field(None, gt=0.0, le=10.0)
    max_angular: float | None = Field(None, gt=0.0, le=10.0)
    max_acceleration: float | None = Field(None, gt=0.0, le=10.0)


class Footprint(Part):
    """How large it is, in metres, along and across its way, about the middle that `odom` tells of.

    Where it is steered, what the scan shows in the strip before it makes it wait.
    """

    length: float = Field(gt=0.0, le=10.0)
    width: float = Field(gt=0.0, le=10.0)


class RobotFile(Part):
    """A whole file. What it says of the robot counts unless a setting says otherwise.

    `topics` are what the robot calls the topics of the contract: ``{odom: wheel/odometry}``.
    Places and the policy stand here, or in files of their own, whose paths begin beside this one:
    `places` as in a locations file, `locations` its path; `policy` as in a policy file,
    `policy_file` its path.
    """

    name: str = Field("", max_length=100, description="what people call it")
    description: str = Field("", max_length=500, description="what it is for, in a sentence")
    namespace: str = Field("/", pattern=r"^/([A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*)?$")
    topics: Mapping[
        Literal["odom", "cmd_vel", "goal_pose", "scan", "camera/image_raw"], GraphName
    ] = Field(default_factory=dict)
    limits: Limits = Limits()
    footprint: Footprint | None = None
    places: LocationsFile | None = None
    locations: Path | None = None
    policy: PolicyFile | None = None
    policy_file: Path | None = None
    skills: Annotated[Mapping[Name, SkillEntry], Field(max_length=MOST_SKILLS)] = Field(
        default_factory=dict
    )

    @model_validator(mode="after")
    def _each_once(self) -> "RobotFile":
        for here, path in (("places", "locations"), ("policy", "policy_file")):
            if getattr(self, here) is not None and getattr(self, path) is not None:
                raise wrong((path,), getattr(self, path), f"nothing: {here} stand in this file")
        return self

    @property
    def about(self) -> str:
        """What it is called and what it is for."""
        called = f"Your name is {self.name}." if self.name else ""
        return " ".join(filter(None, (called, self.description)))
