"""The tables of docs/robots.md: skills, states and topics of each body."""

from collections.abc import Mapping

from docs.markdown import code, table
from docs.told import TOLD, told
from edgevox.agent.skills import SkillSet
from edgevox.agent.skills.skill import OneOf
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.panda.skills import manipulation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.relative_skills import driving_skills, walking_skills


class Elsewhere:
    """Knows places and does not move."""

    places: Mapping[str, tuple[float, float]] = {
        "kitchen": (7.0, 2.0),
        "bedroom": (3.0, 7.0),
        "living_room": (3.0, 3.0),
        "office": (7.0, 7.0),
    }

    def turn(self, angle_rad: float, **_: object) -> None: ...


class Apartment(Elsewhere):
    """Has a battery, too."""

    def battery(self) -> float:
        return 1.0


ROOMS = OneOf(tuple(Elsewhere.places), {"fridge": "kitchen"})
SKILLS: Mapping[str, SkillSet] = {
    "apartment": SkillSet(
        [
            *navigation_skills(
                Apartment(), aliases={"fridge": "kitchen"}, memory=PlaceMemory("apartment", ROOMS)
            ),
            *driving_skills(Elsewhere()),
        ]
    ),
    "panda": SkillSet(manipulation_skills(Elsewhere())),
    "humanoid": SkillSet(walking_skills(Elsewhere())),
}
"""The skills of each robot, without the robot; robot-irsim and robot-external have the first."""


def skills(robot: str) -> str:
    """What a robot can be asked for, and sentences that do so."""
    entries = told(SKILLS[robot], "skills", robot)
    rows = (
        (
            f"`{name}({', '.join(SKILLS[robot][name].arguments_model.model_fields)})`",
            ", ".join(f'"{sentence}"' for sentence in entry["sentences"])
            + (f"; {entry['note']}" if "note" in entry else ""),
        )
        for name, entry in entries.items()
    )
    return table(("skill", "sentences"), rows)


def states() -> str:
    """The keys of `robot_state`, and the standard topics; a test holds them against each body."""
    bodies, topics = TOLD["state"], TOLD["topics"]
    keys = dict.fromkeys(key for told in bodies.values() for key in told)
    rows = [
        (code(key.split(", ")), *(told.get(key, "") for told in bodies.values())) for key in keys
    ]
    rows.append(("on ROS 2", *(code(topics.get(name, ())) for name in bodies)))
    return table(("`robot_state`", *(f"`robot-{name}`" for name in bodies)), rows)
