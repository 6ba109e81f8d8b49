"""What lasts is asked about as a motion is, unless it was plainly said: names of places."""

from types import MappingProxyType

import phrases
import pytest
from support.body import FakeBody
from support.conversation import Talk

from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.skills.skill import OneOf
from edgevox.core.events import Outcome
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.places.skills import place_skills

GO = Call("navigate_to", {"room": "kitchen"})
POINT = Call("remember_place", {"name": "bike stand", "x": 7.5, "y": 2.0})
HERE = Call("remember_place", {"name": "bike stand"})
FORGET = Call("forget_place", {"room": "charger"})


class Standing:
    """Stands at a point, in a world without rooms."""

    places = MappingProxyType({})

    def pose(self):
        return Pose2D(1.0, 2.0, 0.0)

    def velocity(self):
        return Twist2D(0.0, 0.0)

    def state(self):
        return {}


@pytest.fixture
def memory():
    one = PlaceMemory("flat", OneOf(()))
    one.remember("charger", Pose2D(5.0, 5.0, 0.0), "map")
    return one


@pytest.fixture
def listen(memory):
    """Rigs that can be told places; a model has called what the test says."""

    def make(confirm="unsure", *filled_in):
        known = OneOf((), {}, memory.names)
        skills = place_skills(Standing(), memory, known, "room", lambda x_m, y_m: None)
        body = FakeBody(arrives=True)
        goes = body.skills("navigate_to").values()
        talk = Talk(body, confirm=confirm, skills=SkillSet([*goes, *skills]))
        return talk.mean(*filled_in) if filled_in else talk

    return make


@pytest.mark.parametrize("confirm", ["unsure", "always"])
@pytest.mark.parametrize(
    ("calls", "question", "then"),
    [
        (
            [POINT],
            phrases.asks("remember_place", name="bike_stand", x=7.5, y=2.0),
            {"charger": 5.0, "bike stand": 7.5},
        ),
        (
            [HERE],
            phrases.asks("remember_place", name="bike_stand"),
            {"charger": 5.0, "bike stand": 1.0},
        ),
        ([FORGET], phrases.asks("forget_place", room="charger"), {}),
        (
            [GO, POINT],
            "Shall I go to the kitchen and then remember the point x 7.5, y 2 as bike stand?",
            {"charger": 5.0, "bike stand": 7.5},
        ),
    ],
    ids=["a point", "here", "forget", "beside a drive"],
)
def test_what_a_model_called_is_named_and_done_after_a_yes(
    listen, memory, confirm, calls, question, then
):
    with listen(confirm, *calls) as rig:
        assert rig.say("take care of the bikes") == question
        assert rig.outcomes == [Outcome.ASKED]
        assert memory.names() == ("charger",)
        assert rig.body.sent == []
        rig.say("yes")
        assert {name: memory.find(name).x for name in memory.names()} == then
        assert rig.body.sent == ["kitchen"] * (GO in calls)


def test_a_no_leaves_it(listen, memory):
    with listen("unsure", POINT) as rig:
        rig.say("take care of the bikes")
        rig.say("no")
        assert memory.names() == ("charger",)


def test_nothing_of_it_is_done_where_nobody_is_to_be_asked(listen, memory):
    with listen("never", POINT) as rig:
        rig.say("take care of the bikes")
        assert rig.outcomes == [Outcome.REFUSED]
        assert rig.questions == []
        assert memory.names() == ("charger",)


@pytest.mark.parametrize("confirm", ["unsure", "always", "never"])
def test_what_was_plainly_said_is_done_unasked(listen, memory, confirm):
    with listen(confirm) as rig:
        rig.say("remember this place as the bike stand")
        rig.say("forget the place charger")
        assert rig.questions == []
        assert memory.names() == ("bike stand",)
