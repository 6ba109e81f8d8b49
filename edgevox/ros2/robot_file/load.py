"""The loader of robot files, and what a file says beside the skills: places, policy, limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from edgevox.agent.phrases.load import ENGLISH
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
from edgevox.ros2.robot_file.format import Need, RobotFile, SkillEntry, StateEntry
from edgevox.ros2.robot_file.shared import with_shared

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
