"""Places that are remembered on the wire: by the action, by sentences, of any ROS 2 robot."""

import json
import math

import phrases
import pytest
from action_rig import Client
from external_rig import Goal, drive, heard, moving, standing, wheels
from guards import HUNG_S
from peer import wait_until
from std_msgs.msg import String

from edgevox.agent.skills import SkillFailed
from edgevox.robots.places.memory import PlaceStore
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import ExternalSettings, Location, SteeringLimits

LOCATIONS = {"dock": Location(-1.0, 0.0, math.pi)}
QUICK = ExternalSettings(steering=SteeringLimits(max_linear_m_s=0.6, max_angular_rad_s=1.5))


def result_of(client, name, /, **arguments):
    end, result = client.end_of(client.send(name, **arguments))
    assert end == "succeeded", result.error
    return json.loads(result.result_json)


NO_NAMES = {
    "kitchen": "place_of_the_map",
    "stop": "place_name_reserved",
    "../etc": "place_name_wrong",
    "x" * 41: "place_name_long",
}


def test_the_action_remembers_a_place_that_a_new_process_finds(agent, peer, tmp_path):
    one = agent(f"--places={tmp_path}")
    robot = peer()
    client, events = Client(robot), robot.listen("agent_event")
    for name, code in NO_NAMES.items():
        assert not client.send("remember_place", name=name).accepted
        events.wait_for(lambda m, code=code: json.loads(m).get("code") == code)
    assert list(tmp_path.iterdir()) == []
    told = result_of(client, "remember_place", name="charger")
    assert told["frame"] == "map"
    rooms = result_of(client, "list_places")["places"]
    assert rooms["charger"]["remembered"]
    assert not rooms["kitchen"]["remembered"]
    assert one.terminate() == 0

    agent(f"--places={tmp_path}")
    robot = peer()
    client = Client(robot)
    response = robot.listen("response")
    result_of(client, "navigate_to", room="kitchen")
    there = result_of(client, "navigate_to", room="charger")
    assert math.dist((there["x"], there["y"]), (told["x"], told["y"])) < 0.3
    robot.send("text_input", "forget the place charger")
    response.wait_for(lambda m: m == phrases.done("forget_place", room="charger"))
    assert not client.send("navigate_to", room="charger").accepted


@pytest.fixture
def rig(domain, monkeypatch, tmp_path):
    """Starts a body for a robot, with the places of the last one."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    made = []

    def start():
        robot = ExternalRobot("/robot1", LOCATIONS, QUICK)
        robot.place_memory.open(PlaceStore(tmp_path), robot.name)
        made.append(robot)
        robot.start()
        return robot

    yield start
    for one in made:
        one.close()


def skill(robot, name, /, **arguments):
    one = next(skill for skill in robot.skills if skill.name == name)
    return one.function(Goal(), **one.validate(arguments))


@pytest.mark.long
def test_any_ros_2_robot_finds_back_and_looks_as_it_did(rig, domain):
    with wheels("--start=0.5,0.2,1.0", "--map-to-odom=0,0,0", domain=domain, namespace="/robot1"):
        robot = rig()
        heard(robot)
        wait_until(lambda: robot.located()[1] == "map", "the map")
        with pytest.raises(SkillFailed, check=phrases.because("place_stays")):
            skill(robot, "forget_place", location="dock")
        assert skill(robot, "remember_place", name="bookshelf")["frame"] == "map"
        drive(robot, -0.5, -0.2).result()
        robot.close()

        again = rig()
        heard(again)
        wait_until(lambda: again.located()[1] == "map", "the map")
        skill(again, "navigate_to", location="bookshelf")
        pose = again.pose()
        assert math.dist((pose.x_m, pose.y_m), (0.5, 0.2)) < 0.15
        assert pose.yaw_rad == pytest.approx(1.0, abs=0.15)


def test_a_robot_without_a_map_or_on_its_way_or_unheard_is_told_why(rig, domain, peer):
    robot = rig()
    with pytest.raises(SkillFailed) as unheard:
        skill(robot, "remember_place", name="bookshelf")
    assert unheard.value.reason.code == "robot_unheard"
    with wheels(domain=domain, namespace="/robot1"):
        do = peer().node.create_publisher(String, "/robot1/do", 10)
        heard(robot)
        assert skill(robot, "remember_place", name="bookshelf")["frame"] == "odom"
        going = drive(robot, 3.0, 0.0)
        moving(robot)
        with pytest.raises(SkillFailed) as on_its_way:
            skill(robot, "remember_place", name="shelf")
        going.token.cancel("seen enough")
        standing(robot)
        wait_until(lambda: do.get_subscription_count() > 0, "the robot")
        do.publish(String(data="silent"))
        wait_until(lambda: robot.state()["pose"] is None, "silence", HUNG_S)
        with pytest.raises(SkillFailed) as silent:
            skill(robot, "remember_place", name="shelf")
    assert on_its_way.value.reason.code == "place_while_moving"
    assert silent.value.reason.code == "lost"
    assert robot.place_memory.names() == ("bookshelf",)


def test_a_place_of_another_frame_is_not_driven_to(rig, domain):
    with wheels(domain=domain, namespace="/robot1"):
        robot = rig()
        heard(robot)
        robot.place_memory.remember("bookshelf", robot.pose(), "map")
        with pytest.raises(SkillFailed) as refused:
            skill(robot, "navigate_to", location="bookshelf")
    assert refused.value.reason.code == "place_elsewhere"
