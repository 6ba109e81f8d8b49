"""The example's package, installed beside an agent that is typed to over ROS 2."""

import os
from pathlib import Path

import phrases
import pytest
from guards import HUNG_S
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, interfaces

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_ros_skill"
BROKEN = """
from edgevox.agent.skills import skill

def make(context):
    @skill(templates=["fall apart"], moves=False)
    def fall_apart(goal):
        '''Do what is not supported: a node of its own.'''
        import rclpy
        rclpy.create_node("mine")

    return [fall_apart]
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """As pip would have it, and beside it a package whose skill raises."""
    about = tmp_path / "brought-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: brought\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[edgevox.skills]\ndock-hand = dock_hand:dock_hand_skills\nbroken = brought_broken:make\n"
    )
    (tmp_path / "brought_broken.py").write_text(BROKEN)
    path = [str(tmp_path), str(EXAMPLE), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, path)))


@pytest.fixture
def talk(agent, installed, domain, peer):
    """An agent; say something to it, and wait for words in an answer."""

    def start(*arguments, robot="robot-external", namespace="/edgevox"):
        agent(*arguments, robot=robot)
        one = peer(namespace)
        heard = one.listen("response")

        def say(text, *parts):
            for part in parts:
                since = len(heard.messages)
                if part is parts[0]:
                    one.send("text_input", text)
                heard.wait_for(lambda m, p=part: p in m, since=since)
            return heard.messages[-1]

        return say

    with interfaces(domain):
        yield start


def test_skills_of_a_package_are_done_by_sentences_on_any_robot_that_is_on_ros_2(talk, peer):
    say = talk(f"--namespace={NAMESPACE}")
    asked = Asked(peer(NAMESPACE))
    say("honk please", "That was my horn.")
    asked.wait("honk", True)
    say("go to berth four", "Going to berth 4.")
    asked.wait("dock", ["berth 4", ""])
    asked.do("hang")
    say("go to berth 2", "Going to berth 2.")
    asked.wait("dock", ["berth 2", ""])
    say("stop", phrases.said("stopped"))
    asked.wait("cancelled", "berth 2")
    asked.do("refuse")
    say("honk", "My horn does not work.")


def test_what_a_skill_raises_is_not_said_in_any_language(talk, peer):
    say = talk(f"--namespace={NAMESPACE}", "--language=de")
    events = peer().listen("agent_event")
    said = say("fall apart", "ist ein Fehler aufgetreten")
    assert "rclpy" not in said
    events.wait_for(lambda one: "NotInitialized" in one or "rclpy" in one)
    asked = Asked(peer(NAMESPACE))
    say("hupe bitte", "Das war meine Hupe.")
    asked.wait("honk", True)


def test_the_same_package_works_on_a_robot_of_ours_by_the_agents_node(talk, peer):
    """Whose namespace is the agent's: here the robot's interfaces are in the same one."""
    say = talk(f"--ros2-namespace={NAMESPACE}", robot="robot-apartment", namespace=NAMESPACE)
    asked = Asked(peer(NAMESPACE))
    say("honk please", "That was my horn.")
    asked.wait("honk", True)


def test_a_package_that_needs_ros_2_is_off_without_it(agent, installed):
    one = agent("--no-ros2", "--check", "--skills=dock-hand", wait=False)
    one.wait_for_line("skill_package_off")
    assert one.process.wait(HUNG_S) == 0
    assert not [line for line in one.lines if "sound_horn" in line]


def test_skills_of_a_robot_file_and_of_a_package_go_together(agent, installed):
    one = agent(f"--robot-file={ROBOT_FILE}", "--check", robot="robot-external", wait=False)
    one.wait_for_line("temperature:")
    one.wait_for_line("sound_horn: Sound the horn once.")
    assert one.process.wait(HUNG_S) == 0
