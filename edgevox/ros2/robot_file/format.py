"""What a robot file may hold: a robot, its limits and places, and its skills.

`examples/robot_file/cleaner.yaml` has a skill of every kind.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from edgevox.agent.policy import PolicyFile
from edgevox.core.files.validation import wrong
from edgevox.core.files.yaml_file import value_key
from edgevox.core.languages import LANGUAGES
from edgevox.robots.names import LocalNames, check_told_apart
from edgevox.ros2.external.settings import LocationsFile
from edgevox.ros2.robot_file.steps import (
    Comparison,
    GraphName,
    Meaning,
    Name,
    Number,
    Part,
    ResultValue,
    Scalar,
    Step,
    StopStep,
    Topic,
    Wait,
    Word,
    Written,
    at_most,
    one_way,
    wanted_instead,
)

V = TypeVar("V")
MOST_SKILLS = 100
MOST_SHARED = 100
MOST_ARGUMENTS = 20
MOST_WORDS = 500
MOST_STEPS = 20
MOST_WATCHES = 5
MOST_STATES = 50
MOST_NEEDS = 10
BATTERY = "battery"
"""The state that is the charge of the battery."""
FOR_DRIVING = ("topics", "limits", "footprint", "places", "locations", "needs")
"""What a file says of how its robot drives, and where to."""


class WordList(Part):
    """Words to choose from.

    `values` are the words, or map each word to its value in the request. `aliases` are other words
    that people say, in any language; `names` are the names of a word by language.
    """

    values: Annotated[list[Word] | dict[Word, Meaning] | None, at_most(MOST_WORDS, "words")] = None
    aliases: Mapping[Word, Word] = Field(default_factory=dict)
    names: Mapping[Word, LocalNames] = Field(default_factory=dict)

    @property
    def meanings(self) -> Mapping[str, Meaning]:
        """What each word stands for."""
        values = self.values or []
        return values if isinstance(values, dict) else {word: word for word in values}

    @model_validator(mode="after")
    def _knows_its_words(self) -> "WordList":
        for said, word in self.aliases.items():
            if word not in self.meanings:
                raise wrong(("aliases", said), word, "one of " + ", ".join(self.meanings))
        _told_apart(self)
        return self


class SharedList(WordList):
    """A list of words that several skills take."""

    @model_validator(mode="after")
    def _has_words(self) -> "SharedList":
        if not self.values:
            raise wrong(("values",), self.values, "words")
        return self


class Argument(WordList):
    """An argument of a skill: a number, a whole number, true or false, a text, or a choice.

    A choice has words of its own, or those of a `list` of the file.
    EdgeVox multiplies a number by `times` for the request, 0.01 if people say percent and the robot
    expects a fraction, and then adds `plus`. The result is rounded where the field is whole.
    """

    type: Literal["number", "integer", "boolean", "text", "choice"]
    description: str = ""
    unit: str = ""
    min: Number | None = None
    max: Number | None = None
    default: Scalar | None = None
    times: Number | None = None
    plus: Number | None = None
    list: Name | None = None

    @model_validator(mode="after")
    def _fits_its_type(self) -> "Argument":
        if self.list and (self.values or self.type != "choice"):
            raise wrong(("list",), self.list, "nothing: it is for a choice without values")
        if (self.type == "choice") != bool(self.values or self.list):
            raise wrong(("values",), self.values, "words, for a choice and for nothing else")
        for name in ("min", "max", "times", "plus"):
            if getattr(self, name) is not None and self.type not in ("number", "integer"):
                raise wrong((name,), getattr(self, name), "nothing: this is for numbers only")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise wrong(("max",), self.max, f"no less than min, {self.min:g}")
        if self.default is not None and self.list is None:
            words = self.meanings
            expected = wanted_instead(self.default, self.type, words, self.min, self.max)
            if expected:
                raise wrong(("default",), self.default, expected)
        return self


def _told_apart(one: WordList) -> None:
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


def _known_languages(by_code: dict[str, V]) -> dict[str, V]:
    for code in by_code:
        if code not in LANGUAGES or code == "en":
            raise wrong((code,), code, "a code of " + ", ".join(sorted(set(LANGUAGES) - {"en"})))
    return by_code


class Need(Comparison):
    """A condition of a state, without which nothing begins; `failed` says what to do about it."""

    state: Name
    failed: Annotated[str, Field(min_length=1, max_length=200)]
    languages: Annotated[dict[str, str], AfterValidator(_known_languages)] = Field(
        default_factory=dict, description="`failed` in other languages"
    )


SAID = "{value}"
"""Stands for the number that is said in a condition's sentence."""


class Condition(Part):
    """Something that orders can wait for: "when you are docked, beep" by "you are docked".

    `{value}` in every sentence is the number that the state has to be `above` or `below`.
    """

    equals: Scalar | None = None
    above: Number | Literal["{value}"] | None = None
    below: Number | Literal["{value}"] | None = None
    sentences: list[Template] = Field(min_length=1, max_length=50)
    languages: Annotated[dict[str, list[Template]], AfterValidator(_known_languages)] = Field(
        default_factory=dict, description="`sentences` in other languages"
    )

    @model_validator(mode="after")
    def _compares_with_what_is_said(self) -> "Condition":
        self.compared(0.0)
        for one in [*self.sentences, *(one for some in self.languages.values() for one in some)]:
            if (SAID in one) != (SAID in (self.above, self.below)):
                expected = "{value} in each of the sentences, and as above or below; or in none"
                raise wrong(("sentences",), one, expected)
        return self

    def compared(self, value: float | None) -> Comparison:
        """What the state has to be where this number is said."""

        def number(one: float | str | None) -> float | None:
            return value if isinstance(one, str) else one

        return Comparison(equals=self.equals, above=number(self.above), below=number(self.below))


class StateEntry(Sentences):
    """A value that the robot tells of itself: a field of a topic's newest message.

    The robot answers "what is the height" with `done`. A state named `battery` is the charge from 0
    to 1, which EdgeVox asks for, tells and compares by itself. `when` has what orders can wait for.
    """

    topic: GraphName
    type: Word = Field(description="such as sensor_msgs/msg/BatteryState")
    latched: bool = False
    field: Word
    times: Number | None = None
    plus: Number | None = None
    decimals: int = Field(3, ge=0, le=6)
    unit: str = Field("", max_length=40)
    description: str = Field("", max_length=100)
    when: list[Condition] = Field(default_factory=list, max_length=MOST_NEEDS)
    languages: Annotated[dict[str, Sentences], AfterValidator(_known_languages)] = Field(
        default_factory=dict
    )

    @property
    def said(self) -> frozenset[str]:
        """The keys that a skill has as well."""
        return frozenset({*Sentences.model_fields, "description", "languages"})

    @property
    def value(self) -> ResultValue:
        """The value of a message."""
        return ResultValue(
            field=self.field, times=self.times, plus=self.plus, decimals=self.decimals
        )

    @property
    def read(self) -> Topic:
        """The topic, as a skill reads it."""
        return Topic(name=self.topic, type=self.type, latched=self.latched)


class SkillEntry(Step, Sentences):
    """A skill: one step of its own, or a list of `steps` that run in order.

    `moves`: the skill uses the body, so it ends other motion, and every stop ends it; by default
    true for all skills that do more than read. `confirm`: the robot asks for a yes first.
    `undoable`: a person can take it back by word, so that a policy may count down to it. A message
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
    needs: list[Need] = Field(default_factory=list, max_length=MOST_NEEDS)
    moves: bool | None = None
    confirm: bool = False
    undoable: bool = False
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

    @property
    def is_brief(self) -> bool:
        """Whether all its steps usually end at once."""
        return not any(map(_lasts, self.every_step))

    @model_validator(mode="after")
    def _each_step_has_one_way(self) -> "SkillEntry":
        if self.steps and self.ways:
            raise wrong((self.ways[0],), None, "nothing: the skill has steps")
        for index, step in enumerate(self.steps):
            one_way(step, ("steps", index))
        if not self.steps:
            one_way(self, ())
        if self.moves is False and not all(step.read for step in self.every_step):
            _only_short(self)
        if self.undoable and (self.confirm or not self.uses_the_body):
            raise wrong(
                ("undoable",), True, "nothing: only a skill that moves without confirm has it"
            )
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


def _lasts(step: Step) -> bool:
    return bool(step.wait or step.action or (step.publish and step.publish.rate_hz))


def _only_short(entry: SkillEntry) -> None:
    for step in entry.every_step:
        if _lasts(step):
            expected = "true: what takes its time is a goal that a stop can end"
            raise wrong(("moves",), False, expected)


class SharedPhrases(Part):
    """What the sentences of all skills share in one language."""

    rules: Mapping[Name, Template] = Field(default_factory=dict)


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
    namespace: Annotated[
        str,
        Written(
            r"^/([A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*)?$", "a namespace such as /robot1"
        ),
    ] = "/"
    drives: bool = Field(
        True, description="false for an arm, a lift and other robots that stay in place"
    )
    topics: Mapping[
        Literal["odom", "cmd_vel", "goal_pose", "scan", "camera/image_raw", "map", "battery_state"],
        GraphName,
    ] = Field(default_factory=dict)
    limits: Limits = Limits()
    footprint: Footprint | None = None
    places: LocationsFile | None = None
    locations: Path | None = None
    policy: PolicyFile | None = None
    policy_file: Path | None = None
    state: Annotated[Mapping[Name, StateEntry], at_most(MOST_STATES, "states")] = Field(
        default_factory=dict, description="values that the robot tells on its topics"
    )
    needs: list[Need] = Field(
        default_factory=list, max_length=MOST_NEEDS, description="what driving needs"
    )
    lists: Annotated[Mapping[Name, SharedList], at_most(MOST_SHARED, "lists")] = Field(
        default_factory=dict
    )
    rules: Annotated[Mapping[Name, Template], at_most(MOST_SHARED, "rules")] = Field(
        default_factory=dict, description="parts of sentences: <name> in a sentence"
    )
    languages: Annotated[dict[str, SharedPhrases], AfterValidator(_known_languages)] = Field(
        default_factory=dict
    )
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
    def _a_state_is_no_skill(self) -> "RobotFile":
        for name, entry in self.state.items():
            if name in self.skills:
                raise wrong(("state", name), name, "a name that no skill has")
            if name == BATTERY and entry.model_fields_set & entry.said:
                key = min(entry.model_fields_set & entry.said)
                raise wrong(("state", name, key), getattr(entry, key), "nothing: EdgeVox says it")
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
