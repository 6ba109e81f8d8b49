"""What docs/robots.md says of each robot's skills is what the code does."""

import re
from pathlib import Path

import pytest
from support.bodies import BODIES, MEMORY, Nobody

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.skills import SkillSet
from edgevox.apps.robots import ROBOTS
from edgevox.robots.navigation import LOCATION, navigation_skills

PAGE = (Path(__file__).parents[2] / "docs" / "robots.md").read_text()
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL))


class Elsewhere:
    """A robot out there: it knows places, and nothing of a battery."""

    places = Nobody.places


SKILLS = {
    "robot-apartment, robot-irsim": BODIES["apartment"],
    "robot-panda": BODIES["panda"],
    "robot-humanoid": BODIES["humanoid"],
    "robot-external": SkillSet(navigation_skills(Elsewhere(), word=LOCATION, memory=MEMORY)),
}


def rows(heading):
    """Skill, arguments and sentences of each row."""
    found = re.findall(r"^\| `(\w+)\((.*?)\)` \| (.+) \|$", SECTIONS[heading], re.MULTILINE)
    return [
        (skill, arguments.split(", ") if arguments else [], re.findall(r'"(.+?)"', sentences))
        for skill, arguments, sentences in found
    ]


SENTENCES = [
    (heading, skill, sentence)
    for heading in SKILLS
    for skill, _, sentences in rows(heading)
    for sentence in sentences
]


def test_every_robot_has_a_section():
    assert sorted(", ".join(SKILLS).split(", ")) == list(ROBOTS)


@pytest.mark.parametrize("heading", SKILLS)
def test_every_skill_is_there_with_its_arguments_and_no_other(heading):
    told = {skill: arguments for skill, arguments, _ in rows(heading)}
    real = {name: list(one.arguments_model.model_fields) for name, one in SKILLS[heading].items()}
    assert told == real


@pytest.mark.parametrize("heading", SKILLS)
def test_every_skill_has_a_sentence(heading):
    assert all(sentences for _, _, sentences in rows(heading))


@pytest.mark.parametrize(("heading", "skill", "sentence"), SENTENCES)
def test_a_sentence_of_the_page_calls_its_skill(heading, skill, sentence):
    found = Recogniser(SKILLS[heading]).recognise(sentence)

    assert isinstance(found, Understood), found
    (call,) = found.calls
    assert call.skill == skill
    SKILLS[heading][skill].validate(call.arguments)
