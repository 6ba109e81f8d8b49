"""How far an action of a robot file is, told by a field of its feedback that the file names."""

import json
from pathlib import Path

import phrases
import pytest
from action_rig import Client
from example_rig import example
from peer import Peer
from waiting import wait_until

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def sweeper(domain, overlays):
    file = Path(__file__).with_name("sweeper.yaml")
    with example("sweeper", "sweeper_msgs", domain=domain, cache=overlays, file=file) as one:
        yield one


@pytest.fixture
def robot(sweeper):
    """The robot, with nothing done yet."""
    sweeper.asked.do("0.0")
    return sweeper


@pytest.fixture
def events(robot):
    return robot.peer.listen("agent_event")


def told_of(skill, text):
    """How far this skill's goal is by an event; None for an event that does not tell."""
    event = json.loads(text)
    return event.get("feedback", {}).get("progress") if event.get("skill") == skill else None


@pytest.mark.parametrize(
    ("sentence", "skill", "says", "done"),
    [
        ("sweep the lab", "sweep", "Sweeping the lab.", "I swept 12.5 square metres."),
        ("mop the hall", "mop", "Mopping.", "It is mopped."),
    ],
)
def test_what_the_feedback_says_is_how_far_it_is(robot, events, sentence, skill, says, done):
    robot.talk.say(sentence, says)
    robot.asked.do("0.25")
    robot.talk.ask_until("what are you doing", phrases.said("doing", action=says, percent=25))
    events.wait_for(lambda text: told_of(skill, text) == 0.25)
    robot.asked.do("0.7")
    robot.talk.ask_until("what are you doing", phrases.said("doing", action=says, percent=70))
    with robot.talk.told(done):
        robot.asked.do("1.0")


def test_who_asked_by_the_action_is_told_how_far_it_is(robot, domain):
    robot.asked.do("0.5")
    asker = Peer(domain)
    try:
        client = Client(asker)
        goal = client.send("sweep", room="lab")
        wait_until(lambda: 0.5 in [one.get("progress") for one in client.feedback], "its half")
        robot.asked.do("1.0")
        how, _ = client.end_of(goal)
        assert how == "succeeded"
    finally:
        asker.close()


def test_a_part_that_cannot_be_is_not_told(robot, events):
    robot.asked.do("2.5")
    since = len(events.messages)
    robot.talk.say("sweep the lab", "Sweeping the lab.")
    robot.asked.do("0.5")
    robot.talk.ask_until("what are you doing", phrases.said("doing", action="", percent=50).strip())
    with robot.talk.told("I swept 12.5"):
        robot.asked.do("1.0")
    told = {told_of("sweep", one) for one in events.messages[since:]}
    assert told <= {None, 0.5, 1.0}
