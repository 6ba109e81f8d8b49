"""Reads a robot file, and makes its skills."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from edgevox.core.settings import Settings
from edgevox.core.user_file import read_text
from edgevox.core.yaml_file import YamlFile
from edgevox.ros2.robot_file.robot_file_format import RobotFile

T = TypeVar("T")


@dataclass(frozen=True)
class DescribedRobot:
    """What a robot file says, and the file, which knows its lines."""

    robot: RobotFile
    file: YamlFile
    folder: Path

    @property
    def locations(self) -> Path | None:
        """The file of its places: beside the robot file, if its path is relative."""
        return None if self.robot.locations is None else self.folder / self.robot.locations

    @property
    def remappings(self) -> Sequence[str]:
        """ROS arguments by which the contract's topics are those that this robot has."""
        rules = [
            rule for ours, its in self.robot.topics.items() for rule in ("-r", f"{ours}:={its}")
        ]
        return ["--ros-args", *rules] if rules else []

    def namespace(self, settings: Settings) -> str:
        """The namespace of the robot's topics."""
        return self.setting(settings, "external_namespace", self.robot.namespace)

    @staticmethod
    def setting(settings: Settings, name: str, described: T | None) -> T:
        """A setting that somebody gave, else what the file says, else the setting's default."""
        given: T = getattr(settings, name)
        return given if described is None or name in settings.model_fields_set else described


NO_FILE = DescribedRobot(RobotFile(), YamlFile("{}", "robot"), Path())
"""Of a robot that only drives."""


def load_robot_file(path: Path) -> DescribedRobot:
    """Read and check a file, but for the types of its interfaces, which need ROS 2.

    Raises `InvalidValue` naming the file, the line, the field, its value and what was expected.
    """
    file = YamlFile(read_text(path, "robot_file"), path.name)
    return DescribedRobot(file.read(RobotFile, file.data), file, path.parent)
