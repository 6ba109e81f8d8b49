"""An agent that was given nothing but a robot file, typed to over ROS 2."""

import phrases
import pytest
from action_rig import Client
from guards import HUNG_S
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, Talk, interfaces


@pytest.fixture(scope="module")
def robot(domain):
    with interfaces(domain):
        yield


@pytest.fixture
def talk(agent, robot, peer):
    """Say something, and wait for words in an answer."""

    def start(*arguments):
        agent(f"--robot-file={ROBOT_FILE}", *arguments, robot="robot-external")
        return Talk(peer()).say

    return start


def test_all_that_the_robot_can_do_is_done_by_sentences(talk, peer):
    say = talk()
    asked = Asked(peer(NAMESPACE))
    say("sound the horn", "That was loud.")
    asked.wait("honk", True)
    say("lamp to crimson please", "The lamp is red.")
    asked.wait("lamp", 1)
    say("how warm are you", "It is 41.26 degrees.")
    say("dock into slot 4", "I am in slot 3.")
    asked.wait("dock", ["slot 4", "{}"])
    say("vacuum", "not understand")
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


def test_a_skill_that_wants_a_yes_is_asked_about_and_refused_where_nobody_can_be_asked(talk, peer):
    say = talk()
    asked = Asked(peer(NAMESPACE))
    asked.do("obey")
    say("open tray", "Shall I open the tray?")
    say("no", "")
    assert asked.times("fold") == 0
    say("open tray", "Shall I open the tray?")
    say("yes", "The tray is open.")
    asked.wait("fold")
    refused = Client(peer()).send("open_tray")
    assert not refused.accepted


def test_a_file_is_checked_without_a_robot_and_its_fault_is_told(agent, tmp_path):
    checked = agent(f"--robot-file={ROBOT_FILE}", "--check", robot="robot-external", wait=False)
    checked.wait_for_line("honk: Sound the horn.")
    assert checked.process.wait(HUNG_S) == 0
    wrong = tmp_path / "robot.yaml"
    wrong.write_text(ROBOT_FILE.read_text("utf-8").replace("data: 7", "date: 7"))
    refused = agent(f"--robot-file={wrong}", "--check", robot="robot-external", wait=False)
    refused.wait_for_line("skills.blink.request.date: got 7, expected a field that is one of data")
    assert refused.process.wait(HUNG_S) != 0


def test_it_speaks_the_language_of_the_file_and_made_up_sentences(talk, peer):
    say = talk("--language=de")
    asked = Asked(peer(NAMESPACE))
    asked.do("obey")
    say("hupe bitte", "Das war laut.")
    asked.do("refuse")
    say("hupe", "Die Hupe ist kaputt")
    asked.do("obey")
