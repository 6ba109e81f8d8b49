"""examples/robot_file/ur5e/, talked to: MoveIt's action, the driver's modes, a gripper's action."""

import phrases
import pytest
from example_rig import example, play

pytestmark = pytest.mark.long

ARM, GRIPPER = "move_action", "gripper_controller/gripper_cmd"
PACKAGES = ("control_msgs", "moveit_msgs", "ur_dashboard_msgs", "ur_msgs")
JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
HOME = [0.0, -1.571, 0.0, -1.571, 0.0, 0.0]
PACKED = [0.0, -2.356, 2.356, -1.571, -1.571, 0.0]


def moves(positions):
    joints = [
        {"joint_name": f"{name}_joint", "position": position, "weight": 1.0}
        for name, position in zip(JOINTS, positions, strict=True)
    ]
    goal = {"group_name": "ur_manipulator", "goal_constraints": [{"joint_constraints": joints}]}
    return {"request": goal, "planning_options": {"plan_only": False}}


def grips(position):
    return {"command": {"position": position, "max_effort": 20.0}}


@pytest.fixture(scope="module")
def arm(domain, overlays):
    first = ("move to ready", "Moving to ready.", "The arm is at ready.")
    with example("ur5e", *PACKAGES, domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(arm):
    arm.asked.do("obey")
    arm.talk.speak("en")
    return arm.talk


def test_it_moves_to_named_poses_joint_by_joint(talk, arm):
    with arm.asked.within(ARM, moves(HOME)):
        talk.say("move the arm to home", "Moving to home.", "The arm is at home.")
    talk.ask_until("how far is your elbow bent", "My elbow is at 0 degrees.")
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
    talk.ask_until("wie weit ist dein Ellbogen gebeugt", "Mein Ellbogen steht bei 0 Grad.")


def test_a_stop_cancels_the_trajectory(talk, arm):
    arm.asked.do("hang")
    with arm.asked.within(ARM):
        talk.say("move to ready", "Moving to ready.")
    with arm.asked.within("cancelled", ARM):
        talk.say("stop", phrases.said("stopped"))


def test_what_it_does_not_do_it_does_not_claim(talk, arm):
    arm.asked.do("refuse")
    assert "at ready" not in talk.answer("move to ready", after="Moving to ready.")
    arm.asked.do("abort")
    talk.say("move to ready", "I found no way there.")
    arm.asked.do("lie")
    talk.say("move to ready", "The arm did not get there.")
    talk.speak("de")
    talk.say("Arm bereit", "Der Arm ist dort nicht angekommen.")


def test_it_moves_only_with_its_motors_on_and_asks_before_they_come_on(talk, arm):
    arm.asked.do("sleep")
    talk.ask_until("are your motors on", "My motors are off.")
    talk.say("move to ready", "My motors are off. Tell me to wake up.")
    talk.say("wake up", "Shall I switch my motors on?")
    with arm.asked.within("dashboard_client/brake_release"):
        talk.say("yes", "I am ready.")
    talk.say("move to ready", "The arm is at ready.")


def test_after_a_bump_it_waits_to_be_told_and_its_own_reason_is_said(talk, arm):
    arm.asked.do("bump")
    talk.ask_until("what is wrong", "I have hit something")
    talk.say("move to ready", "I have hit something. Look what it is")
    arm.asked.do("refuse")
    talk.say("unlock yourself", "Shall I go on, is the way free?")
    talk.say("yes", "My controller says: it is in local control.")
    arm.asked.do("obey")
    talk.say("recover", "Shall I go on")
    talk.say("yes", "I can move again.")
    talk.ask_until("is everything fine", "All is well.")


def test_numbers_and_constants_reach_the_driver(talk, arm):
    with arm.asked.within(
        "io_and_status_controller/set_speed_slider", {"speed_slider_fraction": 0.3}
    ):
        talk.say("set the speed to 30 percent", "I move at 30 percent.")
    with arm.asked.within("io_and_status_controller/set_io", {"fun": 1, "pin": 4, "state": 1.0}):
        talk.say("switch output 4 on", "Output 4 is on.")


def test_its_scenario_comes_true(talk, arm, domain):
    arm.asked.do("sleep")
    code, told = play("ur5e", "pick", domain)
    assert code == 0, told


def test_it_says_what_it_can_and_nothing_else_and_drives_nowhere(talk, arm):
    can = talk.answer("what can you do")
    assert can.startswith("I can: ")
    assert "move the arm to a named pose" in can
    arm.assert_it_drives_nowhere("I do not know the word 'kitchen'.")
    talk.speak("de")
    talk.say("was kannst du", "den Arm in eine Haltung bringen, die ich kenne; ")


def test_an_arm_that_is_gone_is_not_moved(talk, arm):
    arm.robot_dies()
    talk.ask_until("how far is the elbow bent", "I do not feel my joints.")
    arm.robot_starts()
    talk.ask_until("how far is the elbow bent", "My elbow is at 0 degrees.")
