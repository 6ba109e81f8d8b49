"""What a robot file may hold: a robot, its limits and places, and its skills; and its loader.

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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from edgevox.agent.policy import Policy, PolicyFile
from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import wrong
from edgevox.core.files.yaml_file import YamlFile, value_key
from edgevox.core.languages import LANGUAGES
from edgevox.core.settings import Settings
from edgevox.robots.names import LocalNames, check_told_apart
from edgevox.ros2.external.settings import (
    Location,
    LocationsFile,
    SteeringLimits,
    load_locations,
    read_locations,
)
from edgevox.ros2.robot_file.steps import (
    GraphName,
    Meaning,
    Name,
    Number,
    Part,
    Scalar,
    Step,
    StopStep,
    Wait,
    Word,
    at_most,
    one_way,
    wanted_instead,
)

MOST_SKILLS = 100
MOST_ARGUMENTS = 20
MOST_WORDS = 500
MOST_STEPS = 20
MOST_WATCHES = 5
FOR_DRIVING = ("topics", "limits", "footprint", "places", "locations")
"""What a file says of how its robot drives, and where to."""


class Argument(Part):
    """An argument of a skill: a number, a whole number, true or false, a text, or a choice.

    `values` of a choice are its words, or maps each word to its value in the request. `aliases` are
    other words that people say, in any language; `names` are the names of a word by language.
    EdgeVox multiplies a number by `times` for the request: 0.01 if people say percent and the robot
    expects a fraction.
    """

    type: Literal["number", "integer", "boolean", "text", "choice"]
    description: str = ""
    unit: str = ""
    min: Number | None = None
    max: Number | None = None
    default: Scalar | None = None
    times: Number | None = None
    values: Annotated[list[Word] | dict[Word, Meaning] | None, at_most(MOST_WORDS, "words")] = None
    aliases: Mapping[Word, Word] = Field(default_factory=dict)
    names: Mapping[Word, LocalNames] = Field(default_factory=dict)

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
        _told_apart(self)
        for name in ("min", "max", "times"):
            if getattr(self, name) is not None and self.type not in ("number", "integer"):
                raise wrong((name,), getattr(self, name), "nothing: this is for numbers only")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise wrong(("max",), self.max, f"no less than min, {self.min:g}")
        if self.default is not None:
            words = self.meanings
            expected = wanted_instead(self.default, self.type, words, self.min, self.max)
            if expected:
                raise wrong(("default",), self.default, expected)
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


def _by_value(data: Any) -> Any:
    """With keys that are texts: YAML reads `true` and `3` as what they are."""
    if not isinstance(data, dict):
        return data
    keyed = {value_key(key): said for key, said in data.items()}
    if len(keyed) < len(data):
        raise ValueError("each value once")
    return keyed


ByValue = Annotated[Mapping[str, Word], BeforeValidator(_by_value), at_most(MOST_WORDS, "values")]
"""What is said for values, by how they are written: true, 3, or a text."""


Template = Annotated[str, Field(min_length=1, max_length=1000)]
"""A sentence template. An order with six optional parts in any sequence takes 600 characters."""


class Sentences(Part):
    """The sentences for a skill and the robot's answers, in one language."""

    sentences: list[Template] = Field(default_factory=list, max_length=50)
    says: str = ""
    done: str = ""
    failed: str = ""
    can: str = Field("", description="what the robot can do, as a part of a sentence")
    argument_names: Mapping[Name, Word] = Field(
        default_factory=dict, description="spoken names of arguments: the number of passes"
    )
    asks: str = Field("", description="the end of a question that begins 'Shall I'")
    words: Mapping[Name, ByValue] = Field(
        default_factory=dict, description="spoken words for values: {docked: {true: on my dock}}"
    )


def _known_languages(by_code: dict[str, Sentences]) -> dict[str, Sentences]:
    for code in by_code:
        if code not in LANGUAGES or code == "en":
            raise wrong((code,), code, "a code of " + ", ".join(sorted(set(LANGUAGES) - {"en"})))
    return by_code


class SkillEntry(Step, Sentences):
    """A skill: one step of its own, or a list of `steps` that run in order.

    `moves`: the skill uses the body, so it ends other motion, and every stop ends it; by default
    true for all skills that do more than read. `confirm`: the robot asks for a yes first. A message
    of `stops_on` ends the skill or keeps it from starting. `stop` runs if the skill did not finish,
    in addition to the cancel of an action.
    """

    description: Word
    arguments: Annotated[Mapping[Name, Argument], at_most(MOST_ARGUMENTS, "arguments")] = Field(
        default_factory=dict
    )
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
    def _each_step_hasone_way(self) -> "SkillEntry":
        if self.steps and self.ways:
            raise wrong((self.ways[0],), None, "nothing: the skill has steps")
        for index, step in enumerate(self.steps):
            one_way(step, ("steps", index))
        if not self.steps:
            one_way(self, ())
        if self.moves is False and not all(step.read for step in self.every_step):
            _only_short(self)
        _only_arguments(self, (), self.arguments)
        for code, said in self.languages.items():
            _only_arguments(said, ("languages", code), self.arguments)
        return self


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
    """Limits for steering by EdgeVox if the robot takes no goals, in m/s, rad/s and m/s²."""

    max_linear: Number | None = Field(None, gt=0.0, le=10.0)
    max_angular: Number | None = Field(None, gt=0.0, le=10.0)
    max_acceleration: Number | None = Field(None, gt=0.0, le=10.0)


class Footprint(Part):
    """The robot's size in metres, along and across its direction, around the pose of `odom`.

    If EdgeVox steers the robot, it waits for obstacles that the scan shows in the strip ahead.
    """

    length: Number = Field(gt=0.0, le=10.0)
    width: Number = Field(gt=0.0, le=10.0)


class RobotFile(Part):
    """A robot file. A setting takes precedence over it.

    A robot with `drives: false` has only the skills of this file. `topics` maps the topics of the
    contract to the robot's own names: ``{odom: wheel/odometry}``.
    Places and the policy are in this file or in their own files, with paths relative to this one:
    `places` as in a locations file, or `locations` with its path; `policy` as in a policy file, or
    `policy_file` with its path.
    """

    name: str = Field("", max_length=100, description="the robot's name")
    description: str = Field("", max_length=500, description="its purpose, in a sentence")
    namespace: str = Field("/", pattern=r"^/([A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*)?$")
    drives: bool = Field(
        True, description="false for an arm, a lift and other robots that stay in place"
    )
    topics: Mapping[
        Literal["odom", "cmd_vel", "goal_pose", "scan", "camera/image_raw", "map"], GraphName
    ] = Field(default_factory=dict)
    limits: Limits = Limits()
    footprint: Footprint | None = None
    places: LocationsFile | None = None
    locations: Path | None = None
    policy: PolicyFile | None = None
    policy_file: Path | None = None
    skills: Annotated[
        Mapping[Name, SkillEntry], Field(max_length=MOST_SKILLS), at_most(MOST_SKILLS, "skills")
    ] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _each_once(self) -> "RobotFile":
        for here, path in (("places", "locations"), ("policy", "policy_file")):
            if getattr(self, here) is not None and getattr(self, path) is not None:
                raise wrong((path,), getattr(self, path), f"nothing: {here} stand in this file")
        return self

    @model_validator(mode="after")
    def _drives_where_it_says_how(self) -> "RobotFile":
        for name in () if self.drives else FOR_DRIVING:
            if name in self.model_fields_set:
                raise wrong((name,), getattr(self, name), "nothing: drives is false")
        return self

    @property
    def about(self) -> str:
        """What it is called and what it is for."""
        called = f"Your name is {self.name}." if self.name else ""
        return " ".join(filter(None, (called, self.description)))


T = TypeVar("T")

CLEAR_AHEAD_M = 0.1
"""The clearance in metres from an obstacle ahead, for a robot of known size."""
CLEAR_ASIDE_M = 0.05


@dataclass(frozen=True)
class DescribedRobot:
    """A robot file's content, and the file itself, for its line numbers."""

    robot: RobotFile
    file: YamlFile
    folder: Path

    def places(self, settings: Settings) -> Mapping[str, Location]:
        """Return its places: of the setting's file, else of this one. Raises `InvalidValue`."""
        if settings.locations:
            return load_locations(settings.locations)
        if self.robot.locations:
            return load_locations(self.folder / self.robot.locations)
        return read_locations(self.file.part("places")) if self.robot.places else {}

    @property
    def policy(self) -> Path | Policy | None:
        """The file of its policy, or what this one says of it."""
        if self.robot.policy_file:
            return self.folder / self.robot.policy_file
        return Policy(self.robot.policy) if self.robot.policy else None

    def steering(self, settings: Settings) -> SteeringLimits:
        """Return the limits for steering, where no node takes goals."""
        limits, usual = self.robot.limits, SteeringLimits()
        fastest = self.setting(settings, "max_linear", limits.max_linear)
        steering = SteeringLimits(
            max_linear_m_s=fastest,
            max_angular_rad_s=self.setting(settings, "max_angular", limits.max_angular),
            max_linear_m_s2=limits.max_acceleration or usual.max_linear_m_s2,
        )
        size = self.robot.footprint
        if size is None:
            return steering
        braking_m = fastest**2 / (2 * steering.max_linear_m_s2)
        return replace(
            steering,
            half_width_m=size.width / 2 + CLEAR_ASIDE_M,
            stop_ahead_m=size.length / 2 + braking_m + CLEAR_AHEAD_M,
        )

    @property
    def remappings(self) -> Sequence[str]:
        """ROS arguments by which the contract's topics are those that this robot has."""
        rules = [
            rule for ours, its in self.robot.topics.items() for rule in ("-r", f"{ours}:={its}")
        ]
        return ["--ros-args", *rules] if rules else []

    def namespace(self, settings: Settings) -> str:
        """The namespace of the robot's topics."""
        return self.setting(settings, "robot_namespace", self.robot.namespace)

    @staticmethod
    def setting(settings: Settings, name: str, described: T | None) -> T:
        """Return the setting that was given, else the file's value, else the setting's default."""
        given: T = getattr(settings, name)
        return given if described is None or name in settings.model_fields_set else described


NO_FILE = DescribedRobot(RobotFile(), YamlFile("{}", "robot"), Path())
"""The description of a robot without a file, which only drives."""


def load_robot_file(path: Path) -> DescribedRobot:
    """Read and check a file, except for the types of its interfaces, which need ROS 2.

    Raises `InvalidValue` naming the file, the line, the field, its value and the expected value.
    """
    file = YamlFile(read_text(path, "robot_file"), path.name)
    return DescribedRobot(file.read(RobotFile, file.data), file, path.parent)
