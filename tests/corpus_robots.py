"""The skills of the robots that the corpus is about, without their bodies."""

from functools import lru_cache
from typing import Any

import yaml
from corpus_sentences import FOLDER, Calls, Sentence

from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.skills.arguments import check_arguments
from edgevox.core.errors import InvalidValue
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.navigation import LOCATION, navigation_skills
from edgevox.robots.panda.skills import manipulation_skills
from edgevox.robots.relative_skills import driving_skills, walking_skills


class Nobody:
    """Stands where a body would: its skills are spoken of and never run."""


class _Building(Nobody):
    """A body that knows the places of a building."""

    def __init__(self, places: dict[str, tuple[float, float]]) -> None:
        self.places = places


@lru_cache(maxsize=1)
def skills_of_robots() -> dict[str, SkillSet]:
    """By the names of their robots."""
    nobody: Any = Nobody()
    return {
        "robot-apartment": SkillSet(ApartmentRobot().skills),
        "robot-external": SkillSet(_external_skills()),
        "robot-humanoid": SkillSet(walking_skills(nobody)),
        "robot-panda": SkillSet(manipulation_skills(nobody)),
    }


def is_right(sentence: Sentence, robot: str, calls: Calls) -> bool:
    """Whether this is what should come of the sentence; of another's nothing should."""
    skills = skills_of_robots()[robot]
    outcomes = sentence.outcomes if robot == sentence.robot else ((),)
    return whole(skills, calls) in [whole(skills, outcome) for outcome in outcomes]


def whole(skills: SkillSet, calls: Calls) -> tuple[Call, ...]:
    """With the arguments that a call leaves to their defaults; None of it if one is not valid."""
    return tuple(Call(one.skill, _checked(skills, one)) for one in calls)


def _checked(skills: SkillSet, call: Call) -> dict[str, Any]:
    try:
        checked = check_arguments(call.skill, skills[call.skill].arguments_model, call.arguments)
    except InvalidValue:
        return dict(call.arguments)
    return {n: round(v, 3) if isinstance(v, float) else v for n, v in checked.items()}


def _external_skills() -> tuple[Any, ...]:
    data = yaml.safe_load((FOLDER / "external_locations.yaml").read_text(encoding="utf-8"))
    body: Any = _Building({name: (one["x"], one["y"]) for name, one in data.items()})
    aliases = {alias: name for name, one in data.items() for alias in one.get("aliases", ())}
    return (*navigation_skills(body, aliases=aliases, word=LOCATION), *driving_skills(body))
