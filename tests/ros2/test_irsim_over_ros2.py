"""`robot-irsim` as a peer knows it: it drives by plain sentences, goals and velocities."""

import math

import phrases
import pytest
from bodies_rig import missing_skills, moves, on_ros2, point, stands
from geometry_msgs.msg import PoseStamped, Twist
from interop_rig import Stream, hear, tell, twist
from peer import SENSOR
from sensor_msgs.msg import LaserScan

from tf2_msgs.msg import TFMessage

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def irsim(domain):
    with on_ros2("robot-irsim", domain) as live:
        yield live


def test_it_goes_to_the_kitchen_because_somebody_asked(irsim):
    since = irsim.say("go to the kitchen")

    since.answer(phrases.begins("navigate_to", room="kitchen"))
    since.state(lambda s: s["room"] == "kitchen")
    since.answer(phrases.done("navigate_to", room="kitchen"))

    assert since.event("skill_goal", "succeeded", skill="navigate_to")
    assert irsim.state()["collisions"] == 0


def test_a_stop_word_halts_it_in_the_middle(irsim):
    since = irsim.say("go to the bedroom")
    since.state(moves)

    stopped = irsim.say("halt")

    assert stopped.event("safety_preempt")["word"] == "halt"
    assert stopped.event("skill_cancelled")["skill"] == "navigate_to"
    assert stopped.state(stands)["goal"] is None


def test_a_goal_pose_drives_it_to_a_point_of_its_own_frame(irsim):
    say = tell(irsim.peer, PoseStamped, "/edgevox/goal_pose")
    before, since = irsim.state()["pose"], irsim.from_now()
    say(point("base_link", -0.4, 0.0))
    since.event("skill_goal", "succeeded", skill="navigate_xy")
    after = irsim.state()["pose"]
    away_m = math.hypot(after["x"] - before["x"], after["y"] - before["y"])
    assert away_m == pytest.approx(0.4, abs=0.15)


def test_velocities_turn_it_and_their_silence_halts_it(irsim):
    say = tell(irsim.peer, Twist, "/edgevox/cmd_vel")
    since = irsim.from_now()
    stream = Stream(say, twist(0.0, 0.8))
    turning = since.state(lambda s: s["velocity"]["angular"] > 0.7)
    stream.end()
    stood = irsim.from_now().state(stands)
    assert turning["time"] < stood["time"] < turning["time"] + 3.0


def test_its_base_and_its_lidar_come_at_their_rates_at_most(irsim):
    tf = hear(irsim.peer, TFMessage, "/tf")
    scan = hear(irsim.peer, LaserScan, "/edgevox/scan", SENSOR)
    scan.wait_for_more(10)
    tf.wait_for_more(20)

    (link,) = tf.messages[-1].transforms
    sweep = scan.messages[-1]

    assert (link.header.frame_id, link.child_frame_id) == ("map", "base_link")
    assert tf.never_faster_than(30)
    assert scan.never_faster_than(10)
    assert sweep.header.frame_id == "lidar_link"
    assert len(sweep.ranges) > 300
    near = [r for r in sweep.ranges if sweep.range_min < r < sweep.range_max]
    assert len(near) > 100, "it stands between walls"


def test_it_offers_wheels_and_a_lidar_and_no_camera(irsim):
    assert irsim.offered() == {
        "/tf",
        "/tf_static",
        "pose",
        "odom",
        "scan",
        "cmd_vel",
        "goal_pose",
    }


def test_it_has_the_skills_of_the_contract(irsim):
    assert missing_skills(irsim, "robot-irsim") == set()
