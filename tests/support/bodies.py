"""The skills of all bodies, without the bodies: enough to speak of them and to be spoken to."""

import random
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

from hassil.expression import (
    Alternative,
    Expression,
    ListReference,
    RuleReference,
    Sequence,
    TextChunk,
)
from hassil.parse_expression import parse_sentence

from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import OneOf, Skill, SkillSet
from edgevox.robots.facts import facts_of
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.panda.skills import manipulation_skills, table_facts
from edgevox.robots.pictures import Album, picture_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.relative_skills import driving_skills, walking_skills


class Nobody:
    """Stands where a body would; nothing here moves."""

    places = MappingProxyType(
        {
            "kitchen": (7.0, 2.0),
            "bedroom": (3.0, 7.0),
            "living_room": (3.0, 3.0),
            "office": (7.0, 7),
        }
    )

    def battery(self) -> float:
        return 0.5

    def turn(self, angle_rad: float, **_: object) -> None: ...


class Seer(Nobody):
    """Has a camera."""

    camera_spec = None

    def camera(self) -> None: ...


PICTURES = picture_skills(Seer(), Album(Path("pictures"), 1), lambda _: None)
MEMORY = PlaceMemory("apartment", OneOf(tuple(Nobody.places), {"fridge": "kitchen"}))
BODIES: Mapping[str, SkillSet] = {
    "apartment": SkillSet(
        [
            *navigation_skills(Nobody(), aliases={"fridge": "kitchen"}, memory=MEMORY),
            *driving_skills(Nobody()),
        ]
    ),
    "humanoid": SkillSet([*walking_skills(Nobody()), *PICTURES]),
    "panda": SkillSet([*manipulation_skills(Nobody()), *PICTURES]),
}


class Teller:
    """Stands where a body would that tells facts; it has no battery."""

    def __init__(self, skills: SkillSet, facts: tuple[Skill, ...] = ()) -> None:
        self.skills = tuple(skills.values())
        self.facts = facts


FACTS: Mapping[str, tuple[Skill, ...]] = {
    name: facts_of(Teller(skills, table_facts(Nobody()) if name == "panda" else ()))
    for name, skills in BODIES.items()
}
"""What each body is asked and can only tell."""
SKILLS: Mapping[str, Skill] = {
    f"{body}.{name}": one for body, skills in BODIES.items() for name, one in skills.items()
}


def say_it(book: Phrasebook, one: Skill, template: str, source: random.Random) -> str:
    """A sentence that this template stands for, by chance."""
    heard = {
        name: [said for word in choices.words for said in book.word(word).heard]
        for name, choices in one.choices.items()
    }
    heard["name"] = heard["what"] = ["Zanzibar"]

    def words(name: str) -> str:
        if name == "place":
            return written(source.choice(book.hearing.places), book.rules, words, source)
        return source.choice(heard.get(name, ["0.5", "2", "90"]))

    return written(template, book.rules, words, source)


def written(
    template: str, rules: Mapping[str, str], words: Callable[[str], str], source: random.Random
) -> str:
    """What this template stands for, by chance; `words` returns those of a list."""

    def write(part: Expression) -> str:
        match part:
            case TextChunk():
                return part.original_text
            case Alternative():
                return write(source.choice(part.items))
            case Sequence():
                return "".join(write(item) for item in part.items)
            case ListReference(list_name=name):
                return words(name)
            case RuleReference(rule_name=name):
                return write(_parsed(rules[name]))
        raise TypeError(part)

    return " ".join(write(_parsed(template)).split())


@cache
def _parsed(template: str) -> Expression:
    return parse_sentence(template).expression
