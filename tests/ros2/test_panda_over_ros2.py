"""`robot-panda` as a peer knows it: plain sentences, its hand on /tf, its camera, goals."""

import math

import numpy as np
import phrases
import pytest
from bodies_rig import frames_of, missing_skills, on_ros2, point
from geometry_msgs.msg import PoseStamped
from interop_rig import hear, tell
from peer import SENSOR
from sensor_msgs.msg import CameraInfo, Image

from tf2_msgs.msg import TFMessage

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def panda(domain):
    with on_ros2("robot-panda", domain) as live:
        yield live


def test_the_red_cube_is_put_in_the_left_bin_because_somebody_asked(panda):
    since = panda.say("pick up the red cube and put it in the left bin")

    since.answer(phrases.begins("grasp", object="red_cube"))
    held = since.state(lambda s: s["held"] == "red_cube")
    since.answer(phrases.done("place", object="red_cube", target="left_bin"))
    state = since.state(lambda s: s["held"] is None and s["objects"]["red_cube"]["y"] > 0.3)
    cube = state["objects"]["red_cube"]

    assert since.event("skill_goal", "succeeded", skill="place")
    assert held["goal"]["skill"] in {"grasp", "place"}
    assert (cube["x"], cube["y"]) == (pytest.approx(0.40, abs=0.1), pytest.approx(0.42, abs=0.1))
    assert cube["z"] == pytest.approx(0.03, abs=0.01)
    assert "the red cube in the left bin" in panda.say("what do you see").answer("I see")


def test_a_stop_word_halts_the_arm_in_the_middle(panda):
    tf = hear(panda.peer, TFMessage, "/tf")
    since = panda.say("pick up the green cube")
    since.event("skill_goal", "running")
    since.state(lambda s: s["goal"] is not None and s["goal"]["progress"] > 0.1)

    stopped = panda.say("stop")

    assert stopped.event("safety_preempt")["word"] == "stop"
    assert stopped.event("skill_cancelled")["skill"] == "grasp"
    stopped.answer(phrases.said("stopped"))
    assert stopped.state(lambda s: s["goal"] is None)["held"] is None
    heard = len(tf.messages)
    tf.wait_for(lambda _: len(tf.messages) > heard + 10)
    first, last = (place(tf.messages[number]) for number in (heard, -1))
    assert np.linalg.norm(first - last) < 0.002
    panda.say("go home").answer(phrases.done("goto_home"))


def test_the_hand_is_on_tf_at_most_thirty_times_a_second_as_it_is_really_turned(panda):
    tf = hear(panda.peer, TFMessage, "/tf")
    pose = hear(panda.peer, PoseStamped, "/edgevox/pose")
    pose.wait_for(lambda _: True)
    tf.wait_for_more(20)

    (link,) = tf.messages[-1].transforms
    stamp = link.header.stamp
    same = pose.wait_for(lambda m: m.header.stamp == stamp)
    hand = panda.state()["pose"]

    assert (link.header.frame_id, link.child_frame_id) == ("map", "ee_link")
    assert tf.never_faster_than(30)
    assert place(tf.messages[-1]) == pytest.approx([hand[axis] for axis in "xyz"], abs=2e-3)
    assert same.pose.orientation == link.transform.rotation
    assert approach(link.transform.rotation) == pytest.approx([0, 0, -1], abs=0.02)


def test_its_camera_stands_in_the_room_and_shows_the_table_at_most_five_times_a_second(panda):
    info = hear(panda.peer, CameraInfo, "/edgevox/camera_info", SENSOR)
    image = hear(panda.peer, Image, "/edgevox/image_raw", SENSOR)
    info.wait_for(lambda _: True)
    image.wait_for_more(6)

    picture = image.messages[-1]
    model = info.wait_for(lambda m: m.header == picture.header)
    pixels = np.frombuffer(picture.data, np.uint8).reshape(picture.height, picture.width, 3)

    assert image.never_faster_than(5)
    assert (picture.encoding, picture.step) == ("rgb8", 3 * picture.width)
    assert (model.width, model.height) == (picture.width, picture.height)
    assert picture.header.frame_id == "camera_optical_frame"
    assert has_colour(pixels, 0), "a red cube"
    assert has_colour(pixels, 2), "a blue cube"
    assert frames_of(panda, "/tf_static") == {
        ("map", "camera_link"),
        ("camera_link", "camera_optical_frame"),
    }


def test_a_goal_pose_is_a_point_in_space_for_the_hand(panda):
    say = tell(panda.peer, PoseStamped, "/edgevox/goal_pose")
    since = panda.from_now()
    say(point("map", 0.45, -0.1, 0.35))
    since.event("skill_goal", "succeeded", skill="move_to")
    hand = panda.state()["pose"]
    assert [hand[axis] for axis in "xyz"] == pytest.approx([0.45, -0.1, 0.35], abs=0.01)

    since = panda.from_now()
    say(point("map", 3.0, 0.0, 0.5))
    failed = since.event("skill_goal", "failed", skill="move_to")
    assert "The nearest point that I can reach is" in failed["error"]


def test_it_offers_a_hand_and_a_camera_and_nothing_of_a_robot_on_wheels(panda):
    assert panda.offered() == {
        "/tf",
        "/tf_static",
        "pose",
        "goal_pose",
        "image_raw",
        "camera_info",
    }


def test_it_has_the_skills_of_the_contract(panda):
    assert missing_skills(panda, "robot-panda") == set()


def place(message):
    """Where the hand is, (3,) metres."""
    at = message.transforms[0].transform.translation
    return np.array([at.x, at.y, at.z])


def approach(rotation):
    """The hand's z axis, along which its fingers point, on the map."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    assert math.hypot(x, y, z, w) == pytest.approx(1.0)
    return [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]


def has_colour(pixels, channel):
    """Whether something in the picture clearly has this colour."""
    others = np.delete(pixels, channel, axis=2).max(axis=2).astype(int)
    return np.count_nonzero(pixels[..., channel] - others > 60) > 20
