"""Bodies with a hand and an eye, and bodies without anything, on the wire."""

import math
import threading

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from interop_rig import hear, offer, tell
from peer import SENSOR, STATE
from sensor_msgs.msg import CameraInfo, Image
from waiting import wait_until

from edgevox.agent.skills import GoalHandle, skill
from edgevox.core.transforms import Pose3D
from edgevox.robots.capabilities import CameraImage, CameraSpec
from tf2_msgs.msg import TFMessage

__all__ = ["offer"]


class Statue:
    """A body that can do nothing at all."""

    name = "statue"
    skills = ()

    def __init__(self):
        self._ticks = 0
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._live, name="statue")

    @property
    def time_s(self):
        return self._ticks * 0.01

    def state(self):
        return {}

    def halt(self, reason):
        return False

    def reset(self):
        pass

    def start(self):
        self._thread.start()

    def close(self):
        self._closing.set()
        self._thread.join()

    def _live(self):
        while not self._closing.wait(0.01):
            self._ticks += 1


@skill()
def move_to(goal: GoalHandle, x: float, y: float, z: float) -> dict:
    """Move the hand to a point."""
    return {}


class Arm(Statue):
    """A hand that goes left and rolls, and a camera at the wrist that is slow to draw."""

    name = "arm"
    skills = (move_to,)
    camera_spec = CameraSpec(64, 48, math.pi / 2, Pose3D(0.05, 0.0, 0.1), "end_effector")

    def __init__(self):
        super().__init__()
        self.drawn_by = set()
        self.broken = False
        self._pause = threading.Event()

    def end_effector(self):
        half = self.time_s / 2
        return Pose3D(0.5, self.time_s, 0.4, math.sin(half), 0.0, 0.0, math.cos(half))

    def camera(self):
        self.drawn_by.add(threading.current_thread().name)
        time_s = self.time_s
        self._pause.wait(0.03)
        if self.broken:
            raise RuntimeError("the lens is dirty")
        pixels = np.zeros((48, 64, 3), np.uint8)
        pixels[0, 0] = (1, 2, 3)
        pixels[47, 63] = (250, 251, 252)
        return CameraImage(time_s, pixels)


def topics(peer):
    return {name for name, _ in peer.node.get_topic_names_and_types()}


def test_a_body_without_capabilities_offers_nothing(offer, peer):
    offer(Statue())
    one = peer()
    wait_until(lambda: "edgevox" in one.node.get_node_names(), "the node")
    wait_until(lambda: len(one.node.get_service_names_and_types()) > 12, "its services")
    assert topics(one) == {"/rosout", "/parameter_events"}


def test_an_arm_offers_its_hand_and_no_wheels(offer, peer):
    offer(Arm())
    one = peer()
    wait_until(lambda: "/edgevox/goal_pose" in topics(one), "goal_pose")
    wait_until(lambda: "/tf_static" in topics(one), "tf_static")
    offered = topics(one) - {"/rosout", "/parameter_events"}
    assert offered == {
        "/tf", "/tf_static", "/edgevox/pose", "/edgevox/goal_pose", "/edgevox/image_raw",
        "/edgevox/camera_info",
    }  # fmt: skip


def test_the_hands_true_orientation_is_on_tf_and_pose(offer, peer):
    offer(Arm(), frame_prefix="left/")
    one = peer()
    tf = hear(one, TFMessage, "/tf")
    pose = hear(one, PoseStamped, "/edgevox/pose")
    pose.wait_for(lambda m: True)
    turned = tf.wait_for(lambda m: m.transforms[0].transform.rotation.x > 0.2)
    last = turned.transforms[0]
    same = pose.wait_for(lambda m: m.header.stamp == last.header.stamp)
    assert same.pose.orientation == last.transform.rotation
    assert (last.header.frame_id, last.child_frame_id) == ("map", "left/ee_link")
    turn = last.transform.rotation
    half = last.transform.translation.y / 2
    assert (turn.x, turn.w) == (pytest.approx(math.sin(half)), pytest.approx(math.cos(half)))


def test_pictures_come_with_their_camera_and_are_drawn_on_its_own_thread(offer, peer):
    arm = offer(Arm()).body
    one = peer()
    info = hear(one, CameraInfo, "/edgevox/camera_info", SENSOR)
    image = hear(one, Image, "/edgevox/image_raw", SENSOR)
    info.wait_for(lambda m: True)
    picture = image.wait_for_more(1).messages[-1]
    assert (picture.encoding, picture.width, picture.height, picture.step) == ("rgb8", 64, 48, 192)
    assert list(picture.data[:3]) == [1, 2, 3]
    assert list(picture.data[-3:]) == [250, 251, 252]
    assert picture.header.frame_id == "camera_optical_frame"
    same = info.wait_for(lambda m: m.header == picture.header)
    assert (same.width, same.height, same.distortion_model) == (64, 48, "plumb_bob")
    assert list(same.k) == pytest.approx([24, 0, 31.5, 0, 24, 23.5, 0, 0, 1])
    assert arm.drawn_by == {"edgevox-camera"}


def test_the_optical_frame_looks_along_z(offer, peer):
    offer(Arm())
    static = hear(peer(), TFMessage, "/tf_static", STATE).wait_for(lambda m: True)
    links = {(t.header.frame_id, t.child_frame_id): t.transform for t in static.transforms}
    assert links["ee_link", "camera_link"].translation.x == 0.05
    q = links["camera_link", "camera_optical_frame"].rotation
    assert (q.x, q.y, q.z, q.w) == (-0.5, 0.5, -0.5, 0.5)


def test_nobody_looks_so_nothing_is_drawn(offer, peer):
    arm = offer(Arm()).body
    one = peer()
    hear(one, PoseStamped, "/edgevox/pose").wait_for(lambda m: True)
    wait_until(lambda: arm.time_s > 1.0, "a second")
    assert not arm.drawn_by


def test_a_picture_that_fails_is_counted_and_the_next_one_comes(offer, peer):
    robot = offer(Arm())
    robot.body.broken = True
    image = hear(peer(), Image, "/edgevox/image_raw", SENSOR)
    wait_until(lambda: robot.interop.failed_images > 1, "failures")
    assert not image.messages
    robot.body.broken = False
    image.wait_for(lambda m: True)


def test_a_goal_for_a_hand_is_a_point_in_space_also_from_the_cameras_view(offer, peer):
    robot = offer(Arm())
    one = peer()
    first = hear(one, PoseStamped, "/edgevox/pose").wait_for(lambda m: True)
    say = tell(one, PoseStamped, "/edgevox/goal_pose")
    goal = PoseStamped()
    goal.header.frame_id = "map"
    goal.pose.position.x, goal.pose.position.y, goal.pose.position.z = 0.1, 0.2, 0.3
    say(goal)
    assert robot.asked.wait_for(lambda m: True) == ("move_to", {"x": 0.1, "y": 0.2, "z": 0.3})
    ahead = PoseStamped(header=first.header)
    ahead.header.frame_id = "camera_optical_frame"
    ahead.pose.position.z = 1.0
    say(ahead)
    _, point = robot.asked.wait_for(lambda m: True, since=1)
    assert point["x"] == pytest.approx(0.5 + 0.05 + 1.0, abs=1e-6)
    assert 0.3 < point["z"] < 0.52
