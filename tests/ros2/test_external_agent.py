"""`edgevox-agent robot-external`: sentences drive a robot in another process."""

import json
import sys

import phrases
import pytest
from agent_process import AGENT
from external_rig import Velocities, wheels
from guards import run_program
from peer import SENSOR, STATE
from robot_file_rig import Talk
from robot_states import moving, standing
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool
from waiting import wait_until

LOCATIONS = "desk: {x: 0.8, y: 0.0, aliases: [table]}\ndock: {x: -1.0, y: 0.0}\n"


@pytest.fixture
def locations(tmp_path):
    file = tmp_path / "locations.yaml"
    file.write_text(LOCATIONS)
    return file


def test_a_sentence_drives_a_robot_that_only_speaks_ros_2_once_it_is_there(
    agent, peer, domain, locations
):
    agent(
        "--namespace=/robot1", f"--locations={locations}", "--max-linear=0.6",
        robot="robot-external",
    )  # fmt: skip
    robot = peer()
    response = robot.listen("response")
    robot.send("text_input", "go to x 1 y 2")
    topic = "/robot1/odom"
    why = phrases.why("robot_unheard", topic=topic)
    unheard = f"{why}. {phrases.said('topic', topic=topic)}"
    response.wait_for(lambda m: unheard in m)
    robot.send("text_input", "where are you")
    response.wait_for(lambda m: unheard in m, since=len(response.messages))

    with wheels(domain=domain, namespace="/robot1"):
        asked = Velocities(robot, "/robot1/cmd_vel")
        state = robot.listen("robot_state", STATE)
        state.wait_for(lambda m: json.loads(m)["pose"] is not None)
        topics = {name for name, _ in robot.node.get_topic_names_and_types()}
        assert topics.isdisjoint(f"/edgevox/{one}" for one in ("cmd_vel", "goal_pose", "odom"))
        assert robot.node.count_publishers("/tf") == 0

        robot.send("text_input", "go to the table")
        response.wait_for(lambda m: m == phrases.begins("navigate_to", room="desk"))
        response.wait_for(lambda m: m == phrases.done("navigate_to", location="desk"))
        robot.send("text_input", "where are you")
        response.wait_for(lambda m: m.startswith(phrases.stands(location="desk") + "0."))
        unknown = phrases.opening("unknown_word", argument="location", said="moon")
        robot.send("text_input", "go to the moon")
        response.wait_for(lambda m: m.startswith(unknown))

        robot.send("text_input", "go to the dock")
        state.wait_for(lambda m: json.loads(m)["goal"], since=len(state.messages))
        robot.send("text_input", "stop")
        response.wait_for(lambda m: m == phrases.said("stopped"))
        state.wait_for(lambda m: json.loads(m)["goal"] is None, since=len(state.messages))
        assert max(linear for linear, _ in asked.moving) <= 0.6


def test_the_usual_topic_of_a_battery_is_heard_and_waited_for(agent, peer, domain):
    agent("--namespace=/robot1", robot="robot-external")
    talk = Talk(peer())
    assert "nothing of battery" in talk.answer("how full is your battery")
    assert talk.answer("if your battery is low, where are you") == phrases.refused("no_battery")
    robot = peer("/robot1")
    charge = robot.node.create_publisher(BatteryState, "/robot1/battery_state", SENSOR)
    percent = phrases.done("battery", percent=63)

    def told(percentage: float) -> bool:
        charge.publish(BatteryState(percentage=percentage))
        return percent in talk.answer("how full is your battery")

    wait_until(lambda: told(0.63), "the battery")
    wait_until(lambda: told(63.0), "the battery, by a driver that tells percent")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        pytest.param(
            ["--namespace", "my robot"],
            "robot_namespace: got 'my robot', expected a ROS 2 name",
            marks=pytest.mark.long,
        ),
        (["--locations", "nowhere.yaml"], "locations: got 'nowhere.yaml', expected a file"),
        pytest.param(
            ["--max-linear", "0"],
            "max_linear: got '0', expected greater than 0",
            marks=pytest.mark.long,
        ),
    ],
)
def test_what_cannot_be_is_refused_with_its_field(arguments, said):
    bad = run_program([AGENT, "robot-external", "--text-mode", "--llm=none", *arguments])
    assert bad.returncode == 2
    assert said in bad.stderr


def test_without_rclpy_it_says_what_it_needs():
    program = (
        "import sys; sys.modules['rclpy'] = None\n"
        "from edgevox.apps.agent.main import main; sys.exit(main())"
    )
    done = run_program(
        [sys.executable, "-c", program, "robot-external", "--text-mode", "--llm=none"]
    )
    assert done.returncode == 2
    assert "robot-external needs ROS 2, and rclpy" in done.stderr
    assert "Traceback" not in done.stderr


GUIDED = """
namespace: /robot1
state: {guided: {topic: guided, type: std_msgs/msg/Bool, field: data, latched: true}}
needs: [{state: guided, equals: true, failed: I only drive in guided mode.}]
"""


def test_a_drive_ends_as_soon_as_the_robot_tells_that_what_it_needs_is_lost(
    agent, peer, domain, tmp_path
):
    file = tmp_path / "robot.yaml"
    file.write_text(GUIDED)
    robot = peer()
    with wheels(domain=domain, namespace="/robot1"):
        agent(f"--robot-file={file}", robot="robot-external")
        talk, state = Talk(robot), robot.listen("robot_state", STATE)
        guided = robot.node.create_publisher(Bool, "/robot1/guided", STATE)
        guided.publish(Bool(data=True))
        begun = phrases.begins("drive_forward", distance=10)
        talk.ask_until("drive 10 metres forward", begun)
        state.wait_for(moving)
        with talk.told("I only drive in guided mode."):
            guided.publish(Bool(data=False))
        state.wait_for(standing, since=len(state.messages))
        assert talk.answer("drive 10 metres forward") == "I only drive in guided mode."


def test_a_stop_claims_no_stand_of_a_robot_that_is_not_heard(agent, peer, domain):
    robot = peer()
    with wheels(domain=domain, namespace="/robot1"):
        agent("--namespace=/robot1", robot="robot-external")
        talk, its = Talk(robot), peer("/robot1")
        done = its.listen("done")
        unseen = phrases.why("stop_unseen", topic="/robot1/odom")
        talk.ask_until("stop", phrases.said("standing"))
        assert phrases.why("no_battery") in talk.answer("how full is your battery")
        its.send("do", "silent")
        done.wait_for(lambda m: m == "silent")
        talk.ask_until("stop", unseen)
        assert phrases.said("standing") not in talk.answer("stop")
