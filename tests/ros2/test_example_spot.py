"""examples/robot_file/spot/, talked to: what it needs, what it tells, and why it refuses."""

import phrases
import pytest
from example_rig import example, play

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def spot(domain, overlays):
    first = ("what can you dance", "", "I know 2 dances: twerk and heart.")
    with example("spot", "spot_msgs", domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(spot):
    spot.asked.do("sleep")
    spot.talk.speak("en")
    spot.talk.ask_until("are your motors on", "My motors are off.")
    return spot.talk


def awake(talk, spot):
    with spot.asked.within("power_on"):
        talk.say("wake up", "Waking up.", "I am awake.")
    talk.ask_until("are your motors on", "My motors are on.")


def test_it_walks_only_once_it_is_awake_off_its_dock_and_standing(talk, spot):
    talk.say("go to x 1 y 0", "My motors are off. Tell me to wake up.")
    awake(talk, spot)
    talk.say("go to x 1 y 0", "I am on my dock. Tell me to leave it.")
    with spot.asked.within("undock"):
        talk.say("leave your dock", "I am off my dock.")
    talk.say("sit", "I am sitting.")
    talk.ask_until("are you standing", "I am not on my feet.")
    talk.say("go to x 1 y 0", "I am not standing. Tell me to stand up.")
    with spot.asked.within("set_stand_height", {"height": 0.0}):
        talk.say("stand up", "I am standing.")
    talk.ask_until("are you standing", "I am on my feet.")
    with spot.asked.within("cmd_vel"):
        talk.say("walk forward 20 centimetres", phrases.begins("drive_forward", distance=0.2))


def test_it_tells_its_state_in_words(talk, spot):
    talk.ask_until("how full is your battery", phrases.done("battery", percent=64))
    talk.say("are you docked", "I am on my dock.")
    talk.speak("de")
    talk.say("bist du auf der Ladestation", "Ich bin auf der Ladestation.")


def test_it_stands_as_high_as_it_is_told(talk, spot):
    awake(talk, spot)
    with spot.asked.within("set_stand_height"):
        talk.say("stand up by 10 centimetres", "I am standing.")


def test_its_own_reason_is_said(talk, spot):
    spot.asked.do("refuse")
    talk.say("wake up", "Spot says: the lease is taken by a tablet.")
    talk.speak("de")
    talk.say("wach auf", "Spot sagt: the lease is taken by a tablet.")


def test_a_list_without_entries_is_no_answer(talk, spot):
    talk.say("what can you dance", "I know 2 dances: twerk and heart.")
    spot.asked.do("forget")
    talk.say("what can you dance", "I know no dance yet.")
    spot.asked.do("learn")


def test_its_scenario_comes_true(talk, domain):
    code, told = play("spot", "morning", domain)
    assert code == 0, told
