"""examples/robot_file/lift.yaml, talked to: a lift that is asked by a topic and seen on another."""

import phrases
import pytest
from example_rig import example

pytestmark = pytest.mark.long

LEAVES = {"lift_name": "Lift1", "session_id": "edgevox", "request_type": 0}


def going(floor):
    return {
        "lift_name": "Lift1",
        "session_id": "edgevox",
        "request_type": 1,
        "destination_floor": floor,
        "door_state": 2,
    }


@pytest.fixture(scope="module")
def lift(domain, overlays):
    first = ("go to floor 3", "Going to floor 3.", "Floor 3. The door is open.")
    with example("lift", "rmf_lift_msgs", domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(lift):
    lift.asked.do("obey")
    lift.talk.speak("en")
    return lift.talk


def test_it_goes_to_a_floor_and_says_when_its_door_is_open(talk, lift):
    with lift.asked.within("lift_requests", going("L3")):
        talk.say("go to floor 3", "Going to floor 3.", "Floor 3. The door is open.")
    talk.say("where is the lift", "The lift is on L3.")
    with lift.asked.within("lift_requests", LEAVES):
        talk.say("release the lift", "The lift is free.")


def test_a_floor_that_there_is_not_is_not_asked_for(talk, lift):
    before = lift.asked.times("lift_requests")
    talk.say("floor 7 please", "3")
    talk.say("where is the lift", "The lift is on")
    assert lift.asked.times("lift_requests") == before


def test_it_speaks_german(talk, lift):
    talk.speak("de")
    with lift.asked.within("lift_requests", going("L1")):
        talk.say("Fahr auf Etage 1", "Ich fahre auf Etage 1.", "Etage 1. Die Tür ist offen.")
    talk.say("wo ist der Aufzug", "Der Aufzug ist auf L1.")


def test_a_stop_lets_the_lift_go(talk, lift):
    lift.asked.do("hang")
    with lift.asked.within("lift_requests", going("L0")):
        talk.say("floor 0", "Going to floor 0.")
    with lift.asked.within("lift_requests", LEAVES):
        talk.say("stop", phrases.said("stopped"))


def test_a_door_that_stays_shut_is_no_arrival_and_its_opening_is_told(talk, lift):
    lift.asked.do("lie")
    talk.say("go to floor 2", "Going to floor 2.")
    talk.ask_until("where is the lift", "The lift is on L2.")  # so its shut door was seen, too
    talk.say("tell me when the door opens", "I will tell you.")
    with talk.told("The door is open."):
        lift.asked.do("obey")


def test_it_says_what_it_can_and_nothing_else_and_drives_nowhere(talk, lift):
    talk.say(
        "what can you do",
        "I can: go to a floor and open the door there; wait until the door is open; say on which "
        "floor the lift is; and 2 more things. Let others use the lift again; stop at once.",
    )
    lift.assert_it_drives_nowhere(phrases.opening("not_understood_but"))
    talk.speak("de")
    talk.say("was kannst du", "Ich kann: auf eine Etage fahren und dort die Tür öffnen; ")


def test_a_lift_that_is_gone_is_not_claimed_to_be_anywhere(talk, lift):
    lift.robot_dies()
    talk.ask_until("where is the lift", "I do not hear where the lift is.")
    lift.robot_starts()
    talk.ask_until("where is the lift", "The lift is on L0.")
