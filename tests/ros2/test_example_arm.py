"""examples/robot_file/arm.yaml, talked to: a trajectory controller's and a gripper's actions."""

import phrases
import pytest
from example_rig import example

pytestmark = pytest.mark.long

ARM, GRIPPER = "arm_controller/follow_joint_trajectory", "gripper_controller/gripper_cmd"
HOME = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
PACKED = [0.0, -1.5, 0.0, -2.9, 0.0, 1.4, 0.785]


def moves(positions):
    points = [{"positions": positions, "time_from_start": {"sec": 4}}]
    names = [f"joint{number}" for number in range(1, 8)]
    return {"trajectory": {"joint_names": names, "points": points}}


def grips(position):
    return {"command": {"position": position, "max_effort": 20.0}}


@pytest.fixture(scope="module")
def arm(domain, overlays):
    first = ("move to ready", "Moving to ready.", "The arm is at ready.")
    with example("arm", "control_msgs", domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(arm):
    arm.asked.do("obey")
    arm.talk.speak("en")
    return arm.talk


def test_it_moves_to_named_poses_joint_by_joint(talk, arm):
    with arm.asked.within(ARM, moves(HOME)):
        talk.say("move the arm to home", "Moving to home.", "The arm is at home.")
    talk.ask_until("how far is your elbow bent", "My elbow is at -135 degrees.")
    with arm.asked.within(ARM, moves(PACKED)):
        talk.say("bring the arm to the rest position", "The arm is at packed.")


def test_it_opens_its_hand_so_far_and_knows_what_it_holds(talk, arm):
    with arm.asked.within(GRIPPER, grips(0.04)):
        talk.say("open your hand", "My hand is open.")
    with arm.asked.within(GRIPPER, grips(0.02)):
        talk.say("open the gripper by 4 centimetres", "My hand is open.")
    arm.asked.do("full")
    with arm.asked.within(GRIPPER, grips(0.0)):
        talk.say("take it", "I have it.")
    arm.asked.do("empty")
    talk.say("grab it", "There is nothing in my hand.")


def test_it_speaks_german(talk, arm):
    talk.speak("de")
    with arm.asked.within(ARM, moves(HOME)):
        talk.say("bewege den Arm nach zuhause", "Der Arm geht in", "Der Arm ist in Grundstellung.")
    with arm.asked.within(GRIPPER, grips(0.04)):
        talk.say("öffne den Greifer", "Meine Hand ist offen.")
    talk.ask_until("wie weit ist dein Ellbogen gebeugt", "Mein Ellbogen steht bei -135 Grad.")


def test_a_stop_cancels_the_trajectory(talk, arm):
    arm.asked.do("hang")
    with arm.asked.within(ARM):
        talk.say("move to ready", "Moving to ready.")
    with arm.asked.within("cancelled", ARM):
        talk.say("stop", phrases.said("stopped"))


@pytest.mark.parametrize("how", ["refuse", "abort", "lie"])
def test_what_it_does_not_do_it_does_not_claim(talk, arm, how):
    arm.asked.do(how)
    talk.say("move to ready", "The arm did not get there.")
    talk.speak("de")
    talk.say("Arm bereit", "Der Arm ist dort nicht angekommen.")


def test_it_says_what_it_can_and_nothing_else_and_drives_nowhere(talk, arm):
    talk.say(
        "what can you do",
        "I can: move the arm to a named pose; open the gripper, wholly or by so much; say how "
        "far the elbow is bent; close the gripper around something; stop at once.",
    )
    arm.assert_it_drives_nowhere("I do not know the word 'kitchen'.")
    talk.speak("de")
    talk.say("was kannst du", "Ich kann: den Arm in eine Haltung bringen, die ich kenne; ")


def test_an_arm_that_is_gone_is_not_moved(talk, arm):
    arm.robot_dies()
    talk.ask_until("how far is the elbow bent", "I do not feel my joints.")
    arm.robot_starts()
    talk.ask_until("how far is the elbow bent", "My elbow is at 0 degrees.")
