"""What calls a sentence could be: every value was said, and what was said is not left out."""

import pytest
from corpus_robots import skills_of_robots

from edgevox.agent.nlu.judging import Judged, Readings
from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.skills import Call, SkillSet, skill

READINGS = {name: Readings(skills, "en") for name, skills in skills_of_robots().items()}
BLUE = Call("grasp", {"object": "blue_cube"})
KITCHEN, OFFICE = (Call("navigate_to", {"room": room}) for room in ("kitchen", "office"))


def read(robot: str, text: str) -> Judged | None:
    return READINGS[f"robot-{robot}"].of(text)


def calls(robot: str, text: str) -> list[Call]:
    judged = read(robot, text)
    return list(judged.reading.calls) if judged else []


@pytest.mark.parametrize(
    ("robot", "text", "meant"),
    [
        ("apartment", "back to the kitchen once more, old friend", [KITCHEN]),
        ("apartment", "kitchen, and be fast", [KITCHEN]),
        ("apartment", "to begin with the office, after that the kitchen", [OFFICE, KITCHEN]),
        ("apartment", "goto kicthen", [KITCHEN]),
        ("humanoid", "a quarter turn to the right please", [Call("turn_right", {"degrees": 90.0})]),
        ("humanoid", "an eighth of a turn left", [Call("turn_left", {"degrees": 45.0})]),
        ("humanoid", "wlak forward, two metres", [Call("walk_forward", {"distance": 2.0})]),
        ("apartment", "would you mind going to the kitchen", [KITCHEN]),
        ("apartment", "you're wanted in the kitchen, get a move on", [KITCHEN]),
        ("apartment", "gotta the kitchen", [KITCHEN]),
        ("humanoid", "half a turn to the left", [Call("turn_left", {"degrees": 180.0})]),
        ("humanoid", "step back a metre, robot dear", [Call("walk_backward", {"distance": 1.0})]),
        ("humanoid", "march for word two metres", [Call("walk_forward", {"distance": 2.0})]),
        ("humanoid", "spin left 40 degres", [Call("turn_left", {"degrees": 40.0})]),
        (
            "panda",
            "put your gripper at 0.5, -0.1, 0.4",
            [Call("move_to", {"x": 0.5, "y": -0.1, "z": 0.4})],
        ),
    ],
)
def test_orders_in_the_words_of_strangers_are_read(
    robot: str, text: str, meant: list[Call]
) -> None:
    assert calls(robot, text) == meant


@pytest.mark.parametrize(
    ("robot", "text", "meant"),
    [
        ("apartment", "drive to the kitchen, no, the office", [OFFICE]),
        ("apartment", "not the kitchen, the office", [OFFICE]),
        ("apartment", "don't go to the kitchen, go to the office", [OFFICE]),
        ("apartment", "go to the office, not to the kitchen", [OFFICE]),
        ("apartment", "office not kitchen", [OFFICE]),
        ("panda", "grab the red one... no, the blue one", [BLUE]),
        ("panda", "not the red one, pick up the blue one", [BLUE]),
        ("panda", "lift the blue cube rather than the red one", [BLUE]),
        ("humanoid", "turn left 30 degrees, make that 40", [Call("turn_left", {"degrees": 40.0})]),
        ("humanoid", "spin left, no, right", [Call("turn_right")]),
        ("humanoid", "not left, spin right 20 degrees", [Call("turn_right", {"degrees": 20.0})]),
    ],
)
def test_what_the_speaker_takes_back_is_not_read(robot: str, text: str, meant: list[Call]) -> None:
    assert calls(robot, text) == meant


@pytest.mark.parametrize(
    "text",
    [
        "don't go to the kitchen or the office",
        "go to the kitchen, not the office, the bedroom",
        "go neither to the kitchen nor the office",
        "do not go to the kitchen, not to the office",
        "don't go to the kitchen and the office",
    ],
)
def test_what_may_deny_all_of_it_is_held_back(text: str) -> None:
    judged = read("apartment", text)
    assert judged is None or judged.held_back


def test_the_one_of_a_thing_is_no_number() -> None:
    put = Call("place", {"object": "green_cube", "target": "right_bin"})
    assert calls("panda", "stick the green one in the right bin") == [put]
    assert calls("panda", "stick the green one 1 metre into the right bin") == []


def test_every_number_of_a_call_was_said() -> None:
    assert calls("humanoid", "walk on for 3 metres and 20 centimetres at 40 percent") == []
    assert all(call.skill != "navigate_xy" for call in calls("apartment", "drive to x 3"))


def test_left_and_right_are_those_that_were_said() -> None:
    assert calls("humanoid", "kindly rotate 20 degrees to the left") == [
        Call("turn_left", {"degrees": 20.0})
    ]
    assert calls("humanoid", "kindly rotate 20 degrees to the right") == [
        Call("turn_right", {"degrees": 20.0})
    ]


@pytest.mark.parametrize(
    ("robot", "text"),
    [
        ("apartment", "whatever you do, do not drive to the kitchen"),
        ("apartment", "never ever drive into the kitchen"),
        ("apartment", "my aunt said drive to the kitchen"),
        ("apartment", "when did you drive to the kitchen"),
        ("apartment", "Anna, did you drive to the kitchen"),
        ("panda", "put the banana into the left bin"),
    ],
)
def test_denials_reports_questions_and_unknown_things_are_held_back(robot: str, text: str) -> None:
    judged = read(robot, text)

    assert judged is None or judged.held_back


@pytest.mark.parametrize("text", ["what is seven times eight", "twelve plus thirty", "a" * 400, ""])
def test_what_names_nothing_that_a_skill_takes_has_no_reading(text: str) -> None:
    assert calls("apartment", text) == []


def test_stopping_is_left_to_stop_words_and_templates() -> None:
    assert all(
        call.skill != "stop" for call in calls("apartment", "wait, hold on, stay, to the kitchen")
    )


@skill(templates=("take off [[to] {height} (metres|(metre|m))]",), moves=True)
def take_off(height: float = 2.0) -> None:
    """Take off."""


def test_the_unit_of_a_number_does_not_name_a_skill() -> None:
    skills = SkillSet([take_off])
    lexicon = Lexicon(skills, phrasebook_of("en", skills.values()))
    assert lexicon.words["take_off"].units["height"] == {"metres", "metre", "m"}


@pytest.mark.parametrize("text", ["fly back two metres", "up two metres", "away two metres"])
def test_a_small_word_of_a_sentence_does_not_name_its_motion(text: str) -> None:
    judged = read("external", text)
    assert judged is None or judged.held_back
