"""What a robot tells of itself is asked for by words, and needed by skills and by driving."""

import phrases
import pytest
from robot_file_rig import NAMESPACE, Talk

FILE = f"""
namespace: {NAMESPACE}
state:
  battery: &thermometer
    topic: temperature
    type: sensor_msgs/msg/Temperature
    field: temperature
    times: 0.01
  warmth: {{<<: *thermometer, times: 1.0, decimals: 0, unit: degrees}}
  door:
    topic: door
    type: std_msgs/msg/Bool
    field: data
    sentences: [is the door open]
    done: The door is {{door}}.
    words: {{door: {{true: open, false: shut}}}}
    when:
      - equals: true
        sentences: ["[the|your] door is open"]
        languages: {{de: ["die Tür offen ist"]}}
needs: [{{state: door, equals: true, failed: The door is shut. Open it first.}}]
skills:
  honk:
    description: Sound the horn.
    call: {{name: honk, type: std_srvs/srv/SetBool}}
    request: {{data: true}}
    needs:
      - {{state: door, equals: false, failed: "Not with an open door."}}
      - {{state: battery, above: 0.4, failed: My battery is low.}}
    sentences: [honk]
    failed: "The horn says: {{why}}"
    result: {{why: message}}
    done: That was loud.
  dock:
    description: Drive into the dock.
    action: {{name: dock, type: edgevox_msgs/action/ExecuteSkill}}
    stop: {{call: {{name: honk, type: std_srvs/srv/SetBool}}, request: {{data: false}}}}
    sentences: [dock]
    says: Docking.
    done: I am docked.
  fold:
    description: Fold the arm.
    call: {{name: fold, type: std_srvs/srv/Trigger}}
    needs: [{{state: door, equals: true, failed: The door is in the way.}}]
    sentences: [fold]
    says: Folding.
  sing:
    description: Sing.
    call: {{name: choir, type: std_srvs/srv/Trigger}}
    sentences: [sing]
    says: Singing.
"""


@pytest.fixture(scope="module")
def resident(shared, tmp_path_factory):
    file = tmp_path_factory.mktemp("state") / "robot.yaml"
    file.write_text(FILE)
    return shared(f"--robot-file={file}", robot="robot-external")


@pytest.fixture
def talk(robot):
    return Talk(robot)


def test_a_state_is_asked_for_by_its_name_or_its_own_sentence(talk, asked):
    talk.ask_until("what is the warmth", "The warmth is 41 degrees.")
    talk.ask_until("is the door open", "The door is shut.")
    asked.do("open")
    talk.ask_until("is the door open", "The door is open.")


def test_the_battery_is_told_as_that_of_any_robot(talk, asked):
    talk.ask_until("how full is your battery", phrases.done("battery", percent=41))


def test_a_skill_does_not_begin_where_what_it_needs_is_not_so(talk, asked):
    asked.do("open")
    talk.ask_until("honk", "Not with an open door.")
    asked.do("shut")
    talk.ask_until("honk", "That was loud.")
    asked.wait("honk", True)


def test_driving_needs_its_state_and_the_robots_own_sentence_stands_alone(talk, asked):
    talk.ask_until("is the door open", "The door is shut.")
    talk.say("go to x 1 y 2", "The door is shut. Open it first.")


def test_the_robots_own_reason_is_said_as_it_is_and_quick_skills_say_only_their_end(talk, asked):
    talk.ask_until("is the door open", "The door is shut.")
    asked.do("refuse")
    assert talk.answer("honk") == "The horn says: Traceback: no horn."
    asked.do("obey")
    assert talk.answer("honk") == "That was loud."


def test_an_order_that_the_robot_is_not_ready_for_leaves_the_running_skill_alone(talk, asked):
    talk.ask_until("is the door open", "The door is shut.")
    asked.do("hang")
    talk.say("dock", "Docking.")
    asked.wait("dock")
    assert talk.answer("go to x 1 y 2") == "The door is shut. Open it first."
    assert talk.answer("fold") == "The door is in the way."
    assert "choir is not there" in talk.answer("sing")
    assert "Docking" in talk.answer("what are you doing")
    assert asked.times("cancelled") == asked.times("honk") == 0
    with asked.within("honk", False):
        talk.say("stop", phrases.said("stopped"))


def test_an_order_waits_for_the_battery_by_the_state(talk, asked):
    talk.ask_until("is the door open", "The door is shut.")
    with asked.within("honk", True):
        talk.say("if the battery is below 50 percent honk", "That was loud.")


def test_an_order_waits_for_any_state_by_its_own_words_and_fires_once(talk, asked):
    talk.ask_until("is the door open", "The door is shut.")
    waits = phrases.said("program_when", condition="the door is open", order="going to x 1, y 2.")
    talk.say("when the door is open go to x 1 y 2", waits.split(":")[0])
    with talk.told(phrases.opening("program_now")):
        asked.do("open")
    talk.say("stop", "")


def test_an_order_waits_for_a_number_that_is_said(talk, asked):
    asked.do("shut")
    talk.ask_until("is the door open", "The door is shut.")
    with asked.within("honk", True):
        talk.say("when the warmth is above 30 degrees, honk", "That was loud.")
    talk.say("when the warmth is above 90 degrees, honk", "“the warmth is above 90 degrees”")
    assert "honk" not in talk.answer("what will you do next")


def test_it_waits_in_german_too(talk, asked):
    asked.do("shut")
    talk.speak("de")
    talk.say("wenn die Tür offen ist, fahr nach x 1 y 2", "„die Tür offen ist“")
    talk.speak("en")
