"""`robot-humanoid` as a peer knows it: it walks by plain sentences and by velocities, and sees."""

import phrases
import pytest
from bodies_rig import (
    frames_of,
    missing_skills,
    moves,
    on_ros2,
    stands,
    turned_deg,
    walked_m,
)
from geometry_msgs.msg import PoseStamped, Twist
from interop_rig import Stream, hear, tell, twist
from peer import SENSOR
from sensor_msgs.msg import CameraInfo, Image

from tf2_msgs.msg import TFMessage

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def humanoid(domain):
    with on_ros2("robot-humanoid", domain) as live:
        yield live


def test_half_a_metre_and_a_quarter_turn_are_walked_because_somebody_asked(humanoid):
    before = humanoid.state()
    since = humanoid.say("walk forward half a metre then turn left ninety degrees")

    since.answer(phrases.begins("walk_forward", distance=0.5))
    since.answer(phrases.done("walk_forward", walked=0.5))
    since.answer("I have turned left by")
    after = humanoid.state()

    assert since.event("skill_goal", "succeeded", skill="walk_forward")
    assert since.event("skill_goal", "succeeded", skill="turn_left")
    assert walked_m(before, after) == pytest.approx(0.5, abs=0.1)
    assert turned_deg(before, after) == pytest.approx(90, abs=5)
    assert (after["simulation"], after["fallen"]) == ("physics", False)


def test_a_stop_word_brings_it_to_a_stand_on_its_feet(humanoid):
    since = humanoid.say("walk forward five metres")
    begun = since.state(lambda s: s["velocity"]["linear"] > 0.3)

    stopped = humanoid.say("stop")

    assert stopped.event("safety_preempt")["word"] == "stop"
    assert stopped.event("skill_cancelled")["skill"] == "walk_forward"
    stood = stopped.state(lambda s: s["activity"] == "standing" and stands(s))
    assert stood["goal"] is None
    assert not stood["fallen"]
    assert walked_m(begun, stood) < 1.0
    assert humanoid.process.process.poll() is None


def test_velocities_drive_it_and_their_silence_halts_it(humanoid):
    say = tell(humanoid.peer, Twist, "/edgevox/cmd_vel")
    before = humanoid.state()
    since = humanoid.from_now()
    stream = Stream(say, twist(0.4, 0.3))
    since.state(lambda s: walked_m(before, s) > 0.2 and turned_deg(before, s) > 5)

    stream.end()
    last = humanoid.state()
    silent = humanoid.from_now()
    stood = silent.state(lambda s: s["activity"] == "standing" and stands(s))

    assert stood["time"] - last["time"] < 4.0, "of its own time"
    assert not stood["fallen"]
    assert not moves(humanoid.state())


def test_its_base_is_on_tf_at_most_thirty_times_a_second_and_the_same_on_pose(humanoid):
    tf = hear(humanoid.peer, TFMessage, "/tf")
    pose = hear(humanoid.peer, PoseStamped, "/edgevox/pose")
    pose.wait_for(lambda _: True)
    tf.wait_for_more(20)

    (link,) = tf.messages[-1].transforms
    same = pose.wait_for(lambda m: m.header.stamp == link.header.stamp)
    at, place = link.transform.translation, humanoid.state()["pose"]

    assert (link.header.frame_id, link.child_frame_id) == ("map", "base_link")
    assert tf.never_faster_than(30)
    assert (at.x, at.y, at.z) == pytest.approx((place["x"], place["y"], 0.0), abs=0.02)
    assert (same.pose.position.x, same.pose.position.y) == (at.x, at.y)


def test_it_shows_what_it_sees_at_most_five_times_a_second(humanoid):
    info = hear(humanoid.peer, CameraInfo, "/edgevox/camera_info", SENSOR)
    image = hear(humanoid.peer, Image, "/edgevox/image_raw", SENSOR)
    info.wait_for(lambda _: True)
    image.wait_for_more(6)

    picture = image.messages[-1]
    model = info.wait_for(lambda m: m.header == picture.header)

    assert image.never_faster_than(5)
    assert (picture.encoding, picture.step) == ("rgb8", 3 * picture.width)
    assert len(set(bytes(picture.data))) > 20, "a picture with something in it"
    assert (model.width, model.height) == (picture.width, picture.height)
    assert frames_of(humanoid, "/tf_static") == {
        ("base_link", "camera_link"),
        ("camera_link", "camera_optical_frame"),
    }


def test_it_offers_legs_and_eyes_and_no_lidar_and_no_hand(humanoid):
    assert humanoid.offered() == {
        "/tf",
        "/tf_static",
        "pose",
        "odom",
        "cmd_vel",
        "image_raw",
        "camera_info",
    }


def test_it_has_the_skills_of_the_contract(humanoid):
    assert missing_skills(humanoid, "robot-humanoid") == set()
