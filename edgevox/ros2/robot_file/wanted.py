"""What a robot file expects of the graph: for each interface that it names, who has to be there."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from edgevox.ros2.robot_file.interfaces import InterfaceMissing, Kind, full_name
from edgevox.ros2.robot_file.robot_file_format import RobotFile, SkillEntry
from edgevox.ros2.robot_file.step_format import Step, Topic
from edgevox.ros2.standard_topics import DRIVEN

Role = Literal["service", "action", "publisher", "subscriber"]
"""What the robot has under a name: the other end of what EdgeVox has there."""

_ROLES: dict[str, tuple[Role, Kind]] = {
    "publish": ("subscriber", "msg"),
    "call": ("service", "srv"),
    "action": ("action", "action"),
    "read": ("publisher", "msg"),
    "wait": ("publisher", "msg"),
}
TOPICS = "topics"
"""Whose the topics of the contract are that the robot calls otherwise."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """One interface; `whose` is the skill that needs it, and `name` is as the file writes it.

    `contract` is what the contract calls a topic that is no skill's.
    """

    whose: str
    role: Role
    name: str
    type: str
    latched: bool = False
    contract: str = ""


def wanted_by(robot: RobotFile) -> Iterator[Wanted]:
    """Every interface that the file names, of skills whose types make sense, each once a skill."""
    for topic, name in robot.topics.items():
        row = DRIVEN[topic]
        role: Role = "publisher" if row.direction == "in" else "subscriber"
        yield Wanted(TOPICS, role, name, row.type, contract=topic)
    for skill, entry in robot.skills.items():
        yield from dict.fromkeys(_wanted_by_steps(skill, entry))


def _wanted_by_steps(skill: str, entry: SkillEntry) -> Iterator[Wanted]:
    watches = [Step(wait=one) for one in entry.stops_on]
    for step in (*entry.every_step, *watches, *([entry.stop] if entry.stop else ())):
        way = step.ways[0]
        role, kind = _ROLES[way]
        used = getattr(step, way)
        try:
            type_name = full_name(used.type, kind)
        except InterfaceMissing:
            continue  # the skill is off, which is told by itself
        latched = isinstance(used, Topic) and used.latched
        yield Wanted(skill, role, used.name, type_name, latched)
