"""What people say to an arm at a table."""

from typing import Any

import pytest

from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.skills import SkillSet
from edgevox.robots.panda.skills import manipulation_skills

SAID: dict[str, list[str]] = {
    "grasp red_cube": [
        "pick up the red cube",
        "Pick the red one up, please.",
        "could you grab the red block?",
        "take the red one",
        "pick up the red kube",
    ],
    "grasp blue_cube": ["grab the blue block", "get hold of the blue box"],
    "place it left_bin": ["put it in the left bin", "drop that into the box on the left"],
    "place it": ["put it down", "put it back"],
    "place green_cube right_bin": [
        "put the green cube in the right bin",
        "move the green block to the right box",
    ],
    "place red_cube blue_cube": [
        "put the red cube on the blue cube",
        "stack the red block on top of the blue one",
    ],
    "place blue_cube table": ["put the blue cube on the table"],
    "release": [
        "open the gripper",
        "open your hand",
        "open your hands",
        "let go",
        "drop it",
        "let go of the cube",
    ],
    "goto_home": ["go home", "return to the home position", "robot, please go home now"],
    "move_to 0.4 0.1 0.3": [
        "move to x 0.4 y 0.1 z 0.3",
        "go to 0.4, 0.1, 0.3",
        "move your hand to 0.4 0.1 0.3",
        "move the gripper to x is 0.4, y is 0.1 and z is 0.3",
    ],
    "get_pose": ["where is your hand?", "where are you", "what are you holding?"],
    "list_objects": ["what do you see?", "what is on the table?", "list the objects"],
    "stop": ["stop", "please stop moving", "don't move"],
    "grasp red_cube, place it left_bin": ["pick up the red cube and put it in the left bin"],
    "grasp green_cube, place it right_bin, goto_home": [
        "grab the green cube and place it in the bin on the right and then go home"
    ],
    "move_to 0.4 0.1 0.3, release": ["move to x 0.4 y 0.1 z 0.3 and then open the gripper"],
}
REFUSED = {
    "pick up the purple cube": "I do not know the object 'purple cube'. I know red cube, green",
    "pick up the": "I did not hear which object",
    "put the red cube in the middle bin": "I do not know the target 'middle bin'. I know left bin",
}
NO_COMMANDS = ["what is the weather like", "tell me a joke", "take me to the kitchen"]


@pytest.fixture(scope="module")
def skills() -> SkillSet:
    nobody: Any = None
    return SkillSet(manipulation_skills(nobody))


@pytest.fixture(scope="module")
def recogniser(skills) -> Recogniser:
    return Recogniser(skills)


@pytest.mark.parametrize(
    ("expected", "sentence"), [(call, one) for call, said in SAID.items() for one in said]
)
def test_a_plain_sentence_is_understood(recogniser, expected, sentence) -> None:
    found = recogniser.recognise(sentence)

    assert isinstance(found, Understood)
    calls = [" ".join([c.skill, *map(str, c.arguments.values())]) for c in found.calls]
    assert ", ".join(calls) == expected


@pytest.mark.parametrize(("sentence", "reason"), REFUSED.items())
def test_a_wrong_word_is_refused_by_name(recogniser, sentence, reason) -> None:
    found = recogniser.recognise(sentence)

    assert isinstance(found, RefusedCommand)
    assert found.reason.startswith(reason)


@pytest.mark.parametrize("sentence", NO_COMMANDS)
def test_other_sentences_are_left_to_the_model(recogniser, sentence) -> None:
    assert recogniser.recognise(sentence) is None


def test_no_template_catches_an_example_and_every_example_is_a_valid_call(
    skills, recogniser
) -> None:
    for one in skills.values():
        examples = phrasebook(ENGLISH).examples(one)
        assert examples
        for example in examples:
            assert recogniser.recognise(example.sentence) is None, example.sentence
            one.validate(example.arguments)
