"""examples/robot_file/turtlebot4/, talked to: Nav2 drives it, Create 3's interfaces dock it."""

import json

import phrases
import pytest
from example_rig import example, play
from peer import STATE

RED = {"red": 255, "green": 0, "blue": 0}
DARK = {"red": 0, "green": 0, "blue": 0}


@pytest.fixture(scope="module")
def base(domain, overlays):
    packages = ("irobot_create_msgs", "nav2_msgs")
    first = ("undock", "Leaving my dock.", "I am off my dock.")
    with example("turtlebot4", *packages, domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(base):
    base.asked.do("obey")
    base.talk.speak("en")
    return base.talk


@pytest.mark.long
def test_it_docks_and_undocks_and_tells_how_full_its_battery_is(talk, base):
    with base.asked.within("dock"):
        talk.say("go back to your dock", "Going to my dock.", "I am on my dock.")
    with base.asked.within("undock"):
        talk.say("undock", "Leaving my dock.", "I am off my dock.")
    talk.say("how full is your battery", phrases.done("battery", percent=87))


def test_it_says_whether_it_is_docked(talk, base):
    with base.asked.within("undock"):
        talk.say("undock", "I am off my dock.")
    talk.ask_until("are you docked", "I am not on my dock.")
    talk.speak("de")
    talk.say("stehst du auf der Ladestation", "Ich stehe nicht auf der Ladestation.")
    with base.asked.within("dock"):
        talk.say("dock an", "Ich stehe auf der Ladestation.")
    talk.ask_until("bist du an der Ladestation", "Ich stehe auf der Ladestation.")
    talk.speak("en")
    talk.say("are you on your dock", "I am on my dock.")


def test_it_shines_and_beeps(talk, base):
    with base.asked.within("cmd_lightring", {"leds": [RED] * 6, "override_system": True}):
        talk.say("turn the light to red", "My light is red.")
    with base.asked.within("cmd_lightring", {"leds": [DARK] * 6}):
        talk.say("turn the lights off", "My light is dark.")
    notes = [{"frequency": 880}, {"frequency": 440}]
    with base.asked.within("cmd_audio", {"notes": notes, "append": False}):
        talk.say("beep", "That was me.")


def test_it_drives_by_nav2_and_tells_how_far_it_is(talk, base):
    talk.say("undock", "I am off my dock.")
    talk.ask_until("are you docked", "I am not on my dock.")
    state = base.peer.listen("robot_state", STATE)
    pose = {"pose": {"position": {"x": 1.0, "y": 0.5, "z": 0.0}}}
    with base.asked.within("navigate_to_pose", {"pose": pose}):
        talk.say(
            "go to the kitchen",
            phrases.begins("navigate_to", room="kitchen"),
            phrases.done("navigate_to", location="kitchen"),
        )
    goals = [json.loads(one)["goal"] for one in state.messages]
    assert any(one and 0 < one["progress"] < 1 for one in goals)


def test_it_speaks_german(talk, base):
    talk.speak("de")
    with base.asked.within("dock"):
        talk.say("fahr zur Ladestation", "Ich fahre auf meine", "Ich stehe auf der Ladestation.")
    talk.say("wie voll ist dein Akku", "87 Prozent")
    with base.asked.within("cmd_lightring", {"leds": [RED] * 6}):
        talk.say("Licht rot", "Mein Licht ist rot.")


def test_a_stop_cancels_docking_and_driving(talk, base):
    talk.say("undock", "I am off my dock.")
    talk.ask_until("are you docked", "I am not on my dock.")
    base.asked.do("hang")
    with base.asked.within("dock"):
        talk.say("dock", "Going to my dock.")
    with base.asked.within("cancelled", "dock"):
        talk.say("stop", phrases.said("stopped"))
    with base.asked.within("navigate_to_pose"):
        talk.say("go to the front door", "Going to the front door.")
    with base.asked.within("cancelled", "navigate_to_pose"):
        talk.say("stop", phrases.said("stopped"))


@pytest.mark.parametrize("how", ["refuse", "abort", "lie"])
def test_a_dock_that_is_not_felt_is_not_claimed(talk, base, how):
    base.asked.do(how)
    talk.say("dock", "I could not dock.")
    talk.speak("de")
    talk.say("dock an", "Ich konnte nicht andocken.")


def test_a_base_that_is_gone_tells_nothing(talk, base):
    base.robot_dies()
    talk.ask_until("are you docked", "I do not know whether I am on my dock.")
    base.robot_starts()
    talk.ask_until("are you docked", "I am on my dock.")
    talk.say("undock", "I am off my dock.")


def test_it_drives_only_off_its_dock(talk, base):
    talk.say("dock", "I am on my dock.")
    talk.ask_until("are you docked", "I am on my dock.")
    talk.say("go to the kitchen", "I am on my dock. Tell me to undock.")
    talk.say("undock", "I am off my dock.")


def test_its_scenario_comes_true(talk, domain):
    code, told = play("turtlebot4", "evening", domain)
    assert code == 0, told
