"""What people say to a robot that drives, and what it answers."""

import phrases
import pytest

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import Call, Skill, SkillFailed, SkillSet
from edgevox.agent.skills.skill import OneOf
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.world.load import parse_world

SAID = {
    "navigate_to kitchen": [
        "go to the kitchen",
        "Go to kitchen.",
        "could you please drive to the kitchen?",
        "hey robot, head over to the kitchen",
        "take me to the kitchen please",
        "I want you to move into the kitchen now",
        "let's go to the kitchen",
        "meet me in the kitchen",
        "come back to the kitchen",
    ],
    "navigate_to living_room": [
        "go to the living room",
        "please navigate to living_room",
        "bring me to the living room",
    ],
    "navigate_xy 2.5 3": [
        "go to x 2.5 y 3",
        "drive to x is 2.5 and y is 3",
        "go to 2.5, 3",
        "move to the point 2.5 and 3",
        "head to x 2.5 meters y 3 meters please",
        "go to two and a half, three",
    ],
    "stop": ["stop", "please stop moving", "wait there", "don't move", "halt right now"],
    "get_pose": ["where are you?", "tell me where you are", "which room are you in right now"],
    "battery": [
        "what is your battery level?",
        "how much charge do you have left",
        "how full is your battery",
        "battery status",
    ],
}
NO_COMMANDS = [
    "what is the weather like",
    "tell me a joke",
    "find my keys",
    "how are you today?",
    "the kitchen is a nice place",
]


class StandsInKitchen:
    """A body that has been everywhere already."""

    name = "still"

    def __init__(self) -> None:
        self.places = {"kitchen": (1.0, 2.0), "living_room": (5.0, 2.0)}
        self.goals: list[tuple[float, float]] = []
        self.halted: list[str] = []

    def pose(self) -> Pose2D:
        return Pose2D(1.04, 2.0, 3.1415926)

    def place_at(self, x_m: float, y_m: float) -> str | None:
        return "living_room" if x_m > 1 else None

    def drive_to(self, x_m: float, y_m: float, *, token, report) -> None:
        if x_m > 9:
            raise SkillFailed("That point is outside.")
        self.goals.append((x_m, y_m))

    def halt(self, reason: str) -> bool:
        self.halted.append(reason)
        return True


class Goal:
    token = CancelToken()

    def report(self, **feedback: object) -> None: ...


def by_name(body) -> dict[str, Skill]:
    return {one.name: one for one in navigation_skills(body)}


@pytest.fixture(scope="module")
def apartment_skills() -> SkillSet:
    return SkillSet(ApartmentRobot().skills)


@pytest.mark.parametrize(
    ("meaning", "said"), [(meaning, said) for meaning, all_ in SAID.items() for said in all_]
)
def test_a_plain_command_is_understood_without_a_model(meaning, said, apartment_skills) -> None:
    found = Recogniser(apartment_skills).recognise(said)

    assert isinstance(found, Understood)
    (call,) = found.calls
    words = [v if isinstance(v, str) else f"{v:g}" for v in call.arguments.values()]
    assert " ".join([call.skill, *words]) == meaning


@pytest.mark.parametrize("said", NO_COMMANDS)
def test_what_is_no_command_is_not_taken_for_one(said, apartment_skills) -> None:
    assert Recogniser(apartment_skills).recognise(said) is None


def test_examples_are_valid_calls_that_no_template_catches(apartment_skills) -> None:
    recogniser = Recogniser(apartment_skills)
    for one in apartment_skills.values():
        examples = phrasebook(ENGLISH).examples(one)
        assert len(examples) >= 4 or one.plainly or one.name.endswith(("_place", "_places"))
        for example in examples:
            one.validate(example.arguments)
            found = recogniser.recognise(example.sentence)
            assert not isinstance(found, Understood), example.sentence


def test_examples_speak_of_the_rooms_that_exist() -> None:
    first = phrasebook(ENGLISH).examples(by_name(StandsInKitchen())["navigate_to"])[0]
    hinted = navigation_skills(StandsInKitchen(), {"kitchen": ["I am hungry"]})[0].examples

    assert "kitchen" in first.sentence
    assert [(e.sentence, e.arguments) for e in hinted] == [("I am hungry", {"room": "kitchen"})]


def test_the_skills_drive_halt_and_answer_as_a_person_hears_it() -> None:
    body = StandsInKitchen()
    skills = by_name(body)

    arrived = skills["navigate_to"].function(Goal(), room="kitchen")
    at_point = skills["navigate_xy"].function(Goal(), x=3.0, y=4.0)
    pose = skills["get_pose"].function(Goal())
    stopped = skills["stop"].function(Goal())

    assert body.goals == [(1.0, 2.0), (3.0, 4.0)]
    say = phrasebook("en").report
    assert say(skills["navigate_to"], {}, arrived) == phrases.done("navigate_to", room="kitchen")
    assert say(skills["navigate_xy"], {}, at_point) == phrases.done("navigate_xy", x=1.0, y=2.0)
    assert say(skills["get_pose"], {}, pose).startswith(
        phrases.stands(room="living_room") + "1, y 2"
    )
    assert stopped == {"was_moving": True}
    assert body.halted == ["stop was asked"]
    assert [name for name, one in skills.items() if one.moves] == [
        "navigate_to",
        "navigate_xy",
        "stop",
    ]


def test_what_a_body_lacks_it_is_not_asked_for() -> None:
    text = "robot: {kinematics: {name: diff}, shape: {name: circle}, state: [1, 1, 0]}"
    bare = ApartmentRobot(parse_world(text, "bare.yaml"))

    assert "battery" not in by_name(StandsInKitchen())
    of_the_body = ["navigate_xy", "stop", "get_pose", "battery"]
    of_its_memory = ["remember_place", "forget_place", "list_places"]
    by_an_amount = ["drive_forward", "drive_backward", "turn_left", "turn_right", "turn_around"]
    own = ["navigate_to", "turn_towards", *of_the_body, *of_its_memory, *by_an_amount]
    assert [s.name for s in bare.skills] == own


@pytest.mark.parametrize(
    "call",
    [
        Call("navigate_to", {"room": "moon"}),
        Call("navigate_to", {}),
        Call("navigate_xy", {"x": "nan", "y": 1}),
        Call("navigate_xy", {"x": 1}),
    ],
)
def test_calls_with_wrong_arguments_are_refused_by_name(call: Call, apartment_skills) -> None:
    with pytest.raises(InvalidValue, match=call.skill):
        apartment_skills[call.skill].validate(call.arguments)


def test_it_is_in_a_room_and_at_a_place_that_it_remembers() -> None:
    memory = PlaceMemory("flat", OneOf(("kitchen",)))
    memory.remember("charger", Pose2D(1.0, 2.0, 0.0), "map")
    (drive, *_) = navigation_skills(StandsInKitchen(), memory=memory)

    book = phrasebook(ENGLISH)
    told = [
        book.report(drive, {"room": one}, drive.function(Goal(), one))
        for one in ("kitchen", "charger")
    ]

    assert told == [
        phrases.done("navigate_to", room="kitchen"),
        phrases.done("navigate_to", location="charger"),
    ]
