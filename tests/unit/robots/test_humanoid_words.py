"""What people say to a robot that walks, and what it understands."""

import pytest

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import SkillSet
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.relative_skills import walking_skills


class Body:
    """Goes as far as it is told, in no time."""

    name = "robot-humanoid"

    def __init__(self) -> None:
        self.asked: list[tuple[str, float]] = []

    def pose(self) -> Pose2D:
        return Pose2D(0.0, 0.0, 0.0)

    def state(self) -> dict[str, object]:
        return {"fallen": False}

    def walk(self, distance_m: float, **_: object) -> None:
        self.asked.append(("walk", distance_m))

    def turn(self, angle_rad: float, **_: object) -> None:
        self.asked.append(("turn", round(angle_rad, 4)))

    def stand(self, **_: object) -> bool:
        return False

    def halt(self, reason: str) -> bool:
        return False


class Goal:
    token = CancelToken()

    def report(self, **_: object) -> None: ...


@pytest.fixture
def body() -> Body:
    return Body()


@pytest.fixture
def skills(body) -> SkillSet:
    return SkillSet(walking_skills(body))


def understood(skills: SkillSet, sentence: str) -> list[tuple[str, dict[str, object]]]:
    found = Recogniser(skills).recognise(sentence)
    assert isinstance(found, Understood), sentence
    return [(call.skill, dict(call.arguments)) for call in found.calls]


@pytest.mark.parametrize(
    ("sentence", "skill", "arguments"),
    [
        ("walk forward half a metre", "walk_forward", {"distance": 0.5}),
        ("Walk forward half a meter, please.", "walk_forward", {"distance": 0.5}),
        ("please go ahead two and a half meters", "walk_forward", {"distance": 2.5}),
        ("could you move forward by 30 centimeters", "walk_forward", {"distance": 0.3}),
        ("walk three metres", "walk_forward", {"distance": 3.0}),
        ("go 2 meters straight ahead", "walk_forward", {"distance": 2.0}),
        ("step forward a quarter of a meter", "walk_forward", {"distance": 0.25}),
        ("walk forward a metre", "walk_forward", {"distance": 1.0}),
        ("walk forward one meter", "walk_forward", {"distance": 1.0}),
        ("walk forward", "walk_forward", {}),
        ("go forward one and a half metres", "walk_forward", {"distance": 1.5}),
        ("go back one meter", "walk_backward", {"distance": 1.0}),
        ("walk backwards half a metre", "walk_backward", {"distance": 0.5}),
        ("back up two meters please", "walk_backward", {"distance": 2.0}),
        ("step back", "walk_backward", {}),
        ("turn left ninety degrees", "turn_left", {"degrees": 90.0}),
        ("turn left", "turn_left", {}),
        ("turn to the left by 45 degrees", "turn_left", {"degrees": 45.0}),
        ("rotate thirty degrees left", "turn_left", {"degrees": 30.0}),
        ("rotate 20 degrees counterclockwise", "turn_left", {"degrees": 20.0}),
        ("turn right", "turn_right", {}),
        ("turn right one hundred and eighty degrees", "turn_right", {"degrees": 180.0}),
        ("spin around to the right 360 degrees", "turn_right", {"degrees": 360.0}),
        ("turn around", "turn_around", {}),
        ("please turn round", "turn_around", {}),
        ("make a half turn", "turn_around", {}),
        ("face the other way", "turn_around", {}),
        ("stand still", "stand", {}),
        ("stand up", "stand", {}),
        ("get up", "stand", {}),
        ("please get back up again", "stand", {}),
        ("stand", "stand", {}),
        ("stop walking", "stop", {}),
        ("stay where you are", "stop", {}),
        ("where are you", "get_pose", {}),
        ("which way are you facing", "get_pose", {}),
    ],
)
def test_a_plain_sentence_is_one_call(skills, sentence, skill, arguments) -> None:
    ((name, given),) = understood(skills, sentence)

    assert name == skill
    defaults = {"distance": 1.0, "degrees": 90.0}
    known = skills[skill].validate({})
    assert {key: given.get(key, defaults[key]) for key in known} == {
        key: arguments.get(key, defaults[key]) for key in known
    }


def test_two_commands_in_one_sentence_are_two_calls(skills) -> None:
    assert understood(skills, "walk forward half a metre then turn left ninety degrees") == [
        ("walk_forward", {"distance": 0.5}),
        ("turn_left", {"degrees": 90.0}),
    ]
    assert [name for name, _ in understood(skills, "turn around and walk back two meters")] == [
        "turn_around",
        "walk_backward",
    ]


@pytest.mark.parametrize(
    "sentence", ["walk to the door", "go back to sleep", "turn on the light", "stand by me tonight"]
)
def test_what_only_begins_like_a_command_is_left_to_the_model(skills, sentence) -> None:
    assert Recogniser(skills).recognise(sentence) is None


def test_no_example_for_the_model_is_caught_by_a_template(skills) -> None:
    recogniser = Recogniser(skills)
    for skill in skills.values():
        examples = phrasebook(ENGLISH).examples(skill)
        assert examples
        for example in examples:
            assert recogniser.recognise(example.sentence) is None, example.sentence
            skill.validate(example.arguments)


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("walk_forward", {"distance": 100}, "walk_forward.distance: got 100, expected less than"),
        ("walk_backward", {"distance": 0.001}, "walk_backward.distance: got 0.001, expected great"),
        ("walk_forward", {"distance": -1}, "walk_forward.distance: got -1, expected greater"),
        ("turn_left", {"degrees": 10000}, "turn_left.degrees: got 10000, expected less than"),
        ("turn_right", {"degrees": float("nan")}, "turn_right.degrees: got nan, expected"),
        ("walk_forward", {"steps": 3}, "walk_forward.steps: got 3, expected no such argument"),
    ],
)
def test_what_no_robot_should_do_is_refused_by_name(skills, name, arguments, message) -> None:
    with pytest.raises(InvalidValue, match=message):
        skills[name].validate(arguments)


def test_the_skills_ask_the_body_for_metres_ahead_and_radians_to_the_left(skills, body) -> None:
    for name, arguments in (
        ("walk_forward", {"distance": 0.5}),
        ("walk_backward", {"distance": 2}),
        ("turn_left", {"degrees": 90}),
        ("turn_right", {"degrees": 45}),
        ("turn_around", {}),
    ):
        skills[name].function(Goal(), **skills[name].validate(arguments))

    assert body.asked == [
        ("walk", 0.5),
        ("walk", -2.0),
        ("turn", 1.5708),
        ("turn", -0.7854),
        ("turn", 3.1416),
    ]


def test_what_it_says_is_a_sentence(skills) -> None:
    english = phrasebook("en")
    for skill in skills.values():
        arguments = skill.validate({})
        result = skill.function(Goal(), **arguments)
        done = english.report(skill, arguments, result)
        for said in (english.acknowledge(skill, arguments), done):
            assert bool(done) == (skill.name != "stop")
            assert not said or (said[0].isupper() and said.endswith("."))
