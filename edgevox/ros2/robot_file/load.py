"""The loader of robot files, and what a file says beside the skills.

That is its places, policy and limits, and the lists of words and rules for sentences that its
skills share.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.policy import Policy
from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.settings import Settings
from edgevox.ros2.external.settings import (
    Location,
    SteeringLimits,
    load_locations,
    read_locations,
)
from edgevox.ros2.robot_file.format import (
    Argument,
    Need,
    RobotFile,
    Sentences,
    SkillEntry,
    StateEntry,
    WordList,
)

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
    def sentences(self) -> Mapping[tuple[str, str, str], str]:
        """The skill, the language and the template of each sentence; and its place in the file."""
        entries: list[tuple[tuple[str, str], SkillEntry | StateEntry]]
        entries = [(("skills", name), one) for name, one in self.robot.skills.items()]
        entries += [(("state", name), one) for name, one in self.robot.state.items()]
        return {
            (at[1], code, template): self.file.field((*at, *inner, "sentences", index))
            for at, entry in entries
            for code, said in {ENGLISH: entry, **entry.languages}.items()
            for inner in [() if said is entry else ("languages", code)]
            for index, template in enumerate(said.sentences)
        }

    @property
    def notes(self) -> Sequence[str]:
        """What may not be as its owner thinks: needs that old messages can meet."""
        robot = self.robot
        places: list[tuple[Place, Sequence[Need]]] = [(("needs",), robot.needs)]
        places += [(("skills", name, "needs"), one.needs) for name, one in robot.skills.items()]
        return [
            f"{self.file.field((*at, index))}: {need.state} is latched, so that a message of any"
            " age counts, also of a robot that has fallen silent"
            for at, needs in places
            for index, need in enumerate(needs)
            if need.state in robot.state and robot.state[need.state].latched
        ]

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
    described, problems = read_robot_file(path)
    problems.tell()
    return described


def read_robot_file(path: Path) -> tuple[DescribedRobot, Problems]:
    """Read a file, and what is wrong with it; what is not wrong is read all the same.

    Raises `InvalidValue` for a file that is not even readable as a whole.
    """
    file = YamlFile(read_text(path, "robot_file"), path.name)
    problems = Problems()
    data = file.data
    try:
        robot = RobotFile.model_validate(data)
    except ValidationError as error:
        problems.found += file.explain(error, ()).problems
        robot = RobotFile.model_validate(_without_wrong(data, error))
    robot = with_shared(robot, file, problems)
    return DescribedRobot(robot, file, path.parent), problems


SHARED = {"lists", "rules", "languages", "state"}
"""What skills need of the file: where it is wrong, no more can be said of them."""


def _without_wrong(data: Any, error: ValidationError) -> Mapping[str, Any]:
    """What may be right of the file, for a look at the interfaces of its other skills."""
    wrong = {one["loc"][:2] for one in error.errors()}
    keys = {place[0] for place in wrong if place}
    if not isinstance(data, Mapping) or () in wrong or ("skills",) in wrong or keys & SHARED:
        return {}
    left = {key: value for key, value in data.items() if key not in keys}
    if "skills" in keys:
        skills = data["skills"].items()
        left["skills"] = {name: one for name, one in skills if ("skills", name) not in wrong}
    try:
        RobotFile.model_validate(left)
    except ValidationError:
        return {}
    return left


LONGEST_SENTENCE = 10_000
"""In characters, with its rules written out."""
_RULE = re.compile(r"<([^<>]*)>")


def with_shared(robot: RobotFile, file: YamlFile, problems: Problems) -> RobotFile:
    """Return the robot with its lists and rules where its skills name them."""
    shared = _Shared(robot, file, problems)
    shared.check_rules()
    skills = {name: shared.skill(name, one) for name, one in robot.skills.items()}
    states = {name: shared.state(name, one) for name, one in robot.state.items()}
    return robot.model_copy(update={"skills": skills, "state": states})


class _Shared:
    """What the skills of a robot file share. What is wrong goes to `problems`.

        lists:
          sizes: {values: [small, large], aliases: {big: large}}
        rules:
          please: "[please|could you|I would like]"

    A choice takes its words from a list (``list: sizes``); ``<please>`` in a sentence is what the
    rule says, as in Home Assistant's sentences. `languages` has the rules of another language.
    """

    def __init__(self, robot: RobotFile, file: YamlFile, problems: Problems) -> None:
        self._robot, self._file, self._problems = robot, file, problems

    def check_rules(self) -> None:
        """Find rules that name themselves, or others that there are not."""
        rules = self._robot.rules
        shared = {ENGLISH: rules, **{c: one.rules for c, one in self._robot.languages.items()}}
        for code, its in shared.items():
            at: Place = () if its is rules else ("languages", code)
            for name in its:
                with self._problems.collect():
                    _Rules(self._robot, self._file, code, (*at, "rules", name)).out(f"<{name}>")

    def skill(self, name: str, entry: SkillEntry) -> SkillEntry:
        """The skill with what it names."""
        at: Place = ("skills", name)
        arguments = dict(entry.arguments)
        for argument, one in entry.arguments.items():
            with self._problems.collect():
                arguments[argument] = self._argument(one, (*at, "arguments", argument))
            self._check_default(arguments[argument], (*at, "arguments", argument))
        languages = {
            code: said.model_copy(update={"sentences": self._sentences(said, code, place)})
            for code, said in entry.languages.items()
            if (place := (*at, "languages", code))
        }
        said = self._sentences(entry, ENGLISH, at)
        changed = {"arguments": arguments, "sentences": said, "languages": languages}
        return entry.model_copy(update=changed)

    def state(self, name: str, entry: StateEntry) -> StateEntry:
        """The state with the rules that its conditions name."""
        when = []
        for index, one in enumerate(entry.when):
            at: Place = ("state", name, "when", index)
            said = self._written(one.sentences, ENGLISH, (*at, "sentences"))
            languages = {
                code: self._written(some, code, (*at, "languages", code))
                for code, some in one.languages.items()
            }
            when.append(one.model_copy(update={"sentences": said, "languages": languages}))
        return entry.model_copy(update={"when": when})

    def _argument(self, one: Argument, at: Place) -> Argument:
        if one.list is None:
            return one
        lists = self._robot.lists
        if one.list not in lists:
            expected = "a list: one of " + (", ".join(lists) or "none")
            raise self._file.wrong((*at, "list"), one.list, expected)
        known = {name: getattr(lists[one.list], name) for name in WordList.model_fields}
        return one.model_copy(update=known)

    def _check_default(self, one: Argument, at: Place) -> None:
        words = one.meanings
        if one.list and words and one.default is not None and one.default not in words:
            expected = "one of " + ", ".join(words)
            wrong = self._file.wrong((*at, "default"), one.default, expected)
            self._problems.found.append(wrong)

    def _sentences(self, said: Sentences, code: str, at: Place) -> list[str]:
        written = self._written(said.sentences, code, (*at, "sentences"))
        return [phrasebook(code).with_any_length(one) for one in written]

    def _written(self, templates: Sequence[str], code: str, at: Place) -> list[str]:
        """These templates with their rules written out."""
        found = list(templates)
        for index, one in enumerate(found):
            with self._problems.collect():
                found[index] = _Rules(self._robot, self._file, code, (*at, index)).out(one)
        return found


class _Rules:
    """The rules of a language, for a template at this place of the file."""

    def __init__(self, robot: RobotFile, file: YamlFile, code: str, at: Place) -> None:
        own = robot.languages.get(code)
        self._rules = {**robot.rules, **(own.rules if own else {})}
        self._code, self._file, self._at = code, file, at

    def out(self, template: str, within: tuple[str, ...] = ()) -> str:
        """The template with these rules written out; what phrasebooks call a rule stays one.

        Raises `InvalidValue`.
        """
        found = _RULE.sub(lambda match: self._rule(match[1], within), template)
        if len(found) > LONGEST_SENTENCE:
            expected = f"at most {LONGEST_SENTENCE} characters with its rules"
            raise self._file.wrong(self._at, template, expected)
        return found

    def _rule(self, name: str, within: tuple[str, ...]) -> str:
        if name in within:
            raise self._file.wrong(self._at, f"<{name}>", "a rule that does not name itself")
        if name in self._rules:
            return f"({self.out(self._rules[name], (*within, name))})"
        if name in phrasebook(self._code).rules:
            return f"<{name}>"
        expected = "a rule: one of " + (", ".join(sorted(self._rules)) or "none")
        raise self._file.wrong(self._at, f"<{name}>", expected)
