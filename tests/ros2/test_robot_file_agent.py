"""An agent that was given nothing but a robot file, typed to over ROS 2."""

import phrases
import pytest
from action_rig import Client
from guards import HUNG_S
from robot_file_rig import ROBOT_FILE, Talk


@pytest.fixture(scope="module")
def resident(shared):
    return shared(f"--robot-file={ROBOT_FILE}", robot="robot-external")


@pytest.fixture
def say(robot):
    """Say something, and wait for words in an answer."""
    return Talk(robot).say


def test_all_that_the_robot_can_do_is_done_by_sentences(say, asked):
    say("sound the horn", "That was loud.")
    asked.wait("honk", True)
    say("lamp to crimson please", "The lamp is red.")
    asked.wait("lamp", 1)
    say("how warm are you", "It is 41.26 degrees.")
    say("dock into slot 4", "I am in slot 3.")
    asked.wait("dock", ["slot 4", "{}"])
    say("vacuum", "I cannot do housework.")
    asked.do("hang")
    say("dock", "Docking.")
    asked.wait("dock", ["slot 3", "{}"])
    say("stop", phrases.said("stopped"))
    asked.wait("cancelled", "slot 3")
    # What is done at the stop hangs in the robot; it keeps nobody from the next command.
    asked.wait("honk", False)
    say("stop", phrases.said("stopped"))
    say("lamp to green", "The lamp is green.")
    say("dock", "Docking.")
    say("stop", phrases.said("stopped"))


def test_a_skill_that_wants_a_yes_is_asked_about_and_refused_where_nobody_can_be_asked(
    say, asked, robot
):
    say("open tray", "Shall I open the tray?")
    say("no", "")
    assert asked.times("fold") == 0
    say("open tray", "Shall I open the tray?")
    say("yes", "The tray is open.")
    asked.wait("fold")
    refused = Client(robot).send("open_tray")
    assert not refused.accepted


def test_the_fault_of_a_file_is_told_without_a_robot(agent, tmp_path):
    wrong = tmp_path / "robot.yaml"
    wrong.write_text(ROBOT_FILE.read_text("utf-8").replace("data: 7", "date: 7"))
    refused = agent(f"--robot-file={wrong}", "--check", robot="robot-external", wait=False)
    refused.wait_for_line("skills.blink.request.date: got 7, expected a field that is one of data")
    assert refused.process.wait(HUNG_S) != 0


def test_it_speaks_the_language_of_the_file_and_made_up_sentences(robot, asked):
    talk = Talk(robot)
    talk.speak("de")
    try:
        talk.say("hupe bitte", "Das war laut.")
        asked.do("refuse")
        talk.say("hupe", "Die Hupe ist kaputt")
    finally:
        talk.speak("en")
