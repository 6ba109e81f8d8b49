"""A sentence that docs/robots.md shows calls the skill beside which it stands."""

import sys
from pathlib import Path

import pytest

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.apps.robots import ROBOTS

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts"))

from docs.bodies import SKILLS
from docs.told import TOLD

SENTENCES = [
    (robot, skill, sentence)
    for robot, skills in TOLD["skills"].items()
    for skill, entry in skills.items()
    for sentence in entry["sentences"]
]


def test_every_robot_has_its_skills_on_the_page():
    assert {"irsim", "external", *SKILLS} == {one.removeprefix("robot-") for one in ROBOTS}


@pytest.mark.parametrize(("robot", "skill", "sentence"), SENTENCES)
def test_a_sentence_of_the_page_calls_its_skill(robot, skill, sentence):
    found = Recogniser(SKILLS[robot]).recognise(sentence)

    assert isinstance(found, Understood), found
    (call,) = found.calls
    assert call.skill == skill
    SKILLS[robot][skill].validate(call.arguments)
