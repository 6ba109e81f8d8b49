"""The example's package, installed beside an agent that is typed to over ROS 2."""

import os
from pathlib import Path

import phrases
import pytest
from guards import HUNG_S
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, Talk, interfaces

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


@pytest.fixture(scope="module", autouse=True)
def _installed(tmp_path_factory):
    """As pip would have it, and beside it a package whose skill raises."""
    folder = tmp_path_factory.mktemp("installed")
    about = folder / "brought-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: brought\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[edgevox.skills]\ndock-hand = dock_hand:dock_hand_skills\nbroken = brought_broken:make\n"
    )
    (folder / "brought_broken.py").write_text(BROKEN)
    path = [str(folder), str(EXAMPLE), os.environ.get("PYTHONPATH", "")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join(filter(None, path)))
        yield


def test_skills_of_a_package_are_done_by_sentences_on_any_robot_that_is_on_ros_2(
    agent, peer, domain
):
    with interfaces(domain):
        agent(f"--namespace={NAMESPACE}", robot="robot-external")
        one = peer()
        talk, asked = Talk(one), Asked(peer(NAMESPACE))
        talk.say("honk please", "That was my horn.")
        asked.wait("honk", True)
        talk.say("go to berth four", "Going to berth 4.")
        asked.wait("dock", ["berth 4", ""])
        asked.do("hang")
        talk.say("go to berth 2", "Going to berth 2.")
        asked.wait("dock", ["berth 2", ""])
        talk.say("stop", phrases.said("stopped"))
        asked.wait("cancelled", "berth 2")
        asked.do("refuse")
        talk.say("honk", "My horn does not work.")
        asked.do("obey")

        # In another language, and what a skill raises is said in none.
        talk.speak("de")
        events = one.listen("agent_event")
        said = talk.answer("fall apart")
        assert "ist ein Fehler aufgetreten" in said
        assert "rclpy" not in said
        events.wait_for(lambda one: "NotInitialized" in one or "rclpy" in one)
        talk.say("hupe bitte", "Das war meine Hupe.")


def test_the_same_package_works_on_a_robot_of_ours_by_the_agents_node(agent, peer, domain):
    """Whose namespace is the agent's: here the robot's interfaces are in the same one."""
    with interfaces(domain):
        agent(f"--ros2-namespace={NAMESPACE}")
        one = peer(NAMESPACE)
        asked = Asked(one)
        Talk(one).say("honk please", "That was my horn.")
        asked.wait("honk", True)


def test_a_package_that_needs_ros_2_is_off_without_it(agent):
    one = agent("--no-ros2", "--check", "--skills=dock-hand", wait=False)
    one.wait_for_line("skill_package_off")
    assert one.process.wait(HUNG_S) == 0
    assert not [line for line in one.lines if "sound_horn" in line]


def test_skills_of_a_robot_file_and_of_a_package_go_together(agent):
    one = agent(f"--robot-file={ROBOT_FILE}", "--check", robot="robot-external", wait=False)
    one.wait_for_line("temperature:")
    one.wait_for_line("sound_horn: Sound the horn once.")
    one.wait_for_line("vacuum is off: ")
    assert one.process.wait(HUNG_S) == 1
