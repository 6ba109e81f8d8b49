"""What a mobile body says of itself, as a peer without any knowledge of edgevox hears it."""

import itertools
import math
import time

import pytest
from geometry_msgs.msg import PoseStamped, Twist
from held_ticks import HeldTime
from interop_rig import HALL, Stream, hear, offer, seconds, tell, twist
from nav_msgs.msg import Odometry
from peer import SENSOR, STATE
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from waiting import wait_until

from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.world.load import parse_world
from edgevox.ros2.stamps import to_ns
from tf2_msgs.msg import TFMessage

__all__ = ["offer"]
TICK_S = 1 / 30


@pytest.fixture
def hall():
    return ApartmentRobot(parse_world(HALL, "hall.yaml"))


def links(message):
    return {(one.header.frame_id, one.child_frame_id): one.transform for one in message.transforms}


def yaw(rotation):
    return 2 * math.atan2(rotation.z, rotation.w)


def publishers(peer, topic):
    return peer.node.get_publishers_info_by_topic(topic)


@pytest.mark.parametrize(
    ("topic", "kind", "reliability", "durability"),
    [
        ("/tf", "tf2_msgs/msg/TFMessage", "RELIABLE", "VOLATILE"),
        ("/tf_static", "tf2_msgs/msg/TFMessage", "RELIABLE", "TRANSIENT_LOCAL"),
        ("/edgevox/pose", "geometry_msgs/msg/PoseStamped", "RELIABLE", "VOLATILE"),
        ("/edgevox/odom", "nav_msgs/msg/Odometry", "RELIABLE", "VOLATILE"),
        ("/edgevox/scan", "sensor_msgs/msg/LaserScan", "BEST_EFFORT", "VOLATILE"),
    ],
)
def test_the_graph_shows_what_is_promised(offer, peer, topic, kind, reliability, durability):
    offer()
    one = peer()
    wait_until(lambda: publishers(one, topic), topic)
    (info,) = publishers(one, topic)
    assert info.topic_type == kind
    assert info.qos_profile.reliability.name == reliability
    assert info.qos_profile.durability.name == durability


def test_the_graph_shows_what_is_listened_to(offer, peer):
    offer()
    one = peer()
    for topic, kind, reliability in (
        ("/edgevox/cmd_vel", "geometry_msgs/msg/Twist", "BEST_EFFORT"),
        ("/edgevox/goal_pose", "geometry_msgs/msg/PoseStamped", "RELIABLE"),
    ):
        wait_until(lambda t=topic: one.node.get_subscriptions_info_by_topic(t), topic)
        (info,) = one.node.get_subscriptions_info_by_topic(topic)
        assert (info.topic_type, info.qos_profile.reliability.name) == (kind, reliability)


def test_pose_odom_and_tf_are_the_same_pose_at_the_same_time(offer, peer):
    held = HeldTime()
    robot = offer(ApartmentRobot(speed=0.0), time=held)
    one = peer()
    tf = hear(one, TFMessage, "/tf")
    pose = hear(one, PoseStamped, "/edgevox/pose")
    odom = hear(one, Odometry, "/edgevox/odom")

    all_three = (tf, pose, odom)

    def tick():
        robot.body.advance(TICK_S)
        held.advance(TICK_S)

    compared = []

    def together():
        # Of the ticks before all three were heard something may still be on its way.
        stamps = [
            tf.messages[-1].transforms[0].header.stamp,
            *(m.header.stamp for m in (pose.messages[-1], odom.messages[-1])),
        ]
        return stamps.count(stamps[0]) == len(stamps) and stamps[0] not in compared

    wait_until(lambda: tick() or all(heard.messages for heard in all_three), "one of each")
    robot.body.set_velocity(Twist2D(0.3, 0.5))
    for _ in range(round(0.4 / TICK_S)):
        tick()
        wait_until(together, "all three of a new moment")
        transforms, here, moving = (heard.messages[-1] for heard in all_three)
        compared.append(here.header.stamp)
        assert here.header.frame_id == "map"
        (link,) = transforms.transforms
        assert (link.header.frame_id, link.child_frame_id) == ("map", "base_link")
        assert link.header.stamp == here.header.stamp == moving.header.stamp
        there = link.transform.translation
        assert (there.x, there.y, there.z) == (
            here.pose.position.x,
            here.pose.position.y,
            here.pose.position.z,
        )
        assert link.transform.rotation == here.pose.orientation
        assert moving.pose.pose == here.pose
    assert (moving.header.frame_id, moving.child_frame_id) == ("map", "base_link")
    assert moving.twist.twist.linear.x == pytest.approx(0.3, abs=0.02)
    assert moving.twist.twist.angular.z == pytest.approx(0.5, abs=0.05)


class Living(ApartmentRobot):
    """A robot whose own time is the machine's, at every moment."""

    @property
    def time_s(self):
        return time.monotonic()


def test_stamps_are_now_never_later_and_never_twice(offer, peer):
    held = HeldTime()
    offer(Living(speed=0.0), time=held)
    one = peer()
    now = one.node.get_clock()
    tf = hear(one, TFMessage, "/tf")
    wait_until(lambda: held.advance(TICK_S) or tf.messages, "a first transform")
    stamps = []
    for _ in range(20):
        before_ns = now.now().nanoseconds
        held.advance(TICK_S)
        after_ns = now.now().nanoseconds
        tf.wait_until(lambda since=before_ns: tf.sent_ns[-1] >= since)
        stamps.append(to_ns(tf.messages[-1].transforms[0].header.stamp))
        assert before_ns <= stamps[-1] <= after_ns
    assert stamps == sorted(set(stamps))


def test_a_late_joiner_learns_where_the_lidar_is(offer, peer):
    offer(
        ApartmentRobot(
            parse_world(
                HALL + "  sensors: [{name: lidar2d, number: 7, range_max: 5,"
                " angle_range: 3.0, offset: [0.1, 0.05, 0.3]}]\n",
                "hall.yaml",
            )
        )
    )
    one = peer()
    scan = hear(one, LaserScan, "/edgevox/scan", SENSOR).wait_for(lambda m: True)
    static = hear(one, TFMessage, "/tf_static", STATE).wait_for(lambda m: True)
    mount = links(static)["base_link", "lidar_link"]
    assert (mount.translation.x, mount.translation.y) == (0.1, 0.05)
    assert yaw(mount.rotation) == pytest.approx(0.3)
    assert scan.header.frame_id == "lidar_link"
    assert len(scan.ranges) == 7
    assert scan.angle_min == pytest.approx(-1.5)
    assert scan.angle_max == pytest.approx(1.5)
    assert scan.angle_increment == pytest.approx(0.5)
    assert (scan.time_increment, scan.scan_time) == (0.0, pytest.approx(0.1))
    assert scan.range_max == pytest.approx(5.0)


def test_a_scan_sees_the_walls_and_nothing_is_infinite(offer, peer, hall):
    offer(hall)
    scan = hear(peer(), LaserScan, "/edgevox/scan", SENSOR).wait_for(lambda m: True)
    to_east = round((-0.5 - scan.angle_min) / scan.angle_increment)
    assert scan.ranges[to_east] == pytest.approx(7.0, abs=0.02)
    assert all(scan.range_min <= r <= scan.range_max or math.isinf(r) for r in scan.ranges)


def test_the_chain_through_odom_is_the_pose_and_survives_a_reset(offer, peer, hall):
    robot = offer(hall, odom_frame="odom")
    one = peer()
    tf = hear(one, TFMessage, "/tf")
    odom = hear(one, Odometry, "/edgevox/odom")
    first = odom.wait_for(lambda m: True)
    assert (first.header.frame_id, first.child_frame_id) == ("odom", "base_link")
    assert (first.pose.pose.position.x, first.pose.pose.position.y) == (0.0, 0.0)
    stream = Stream(tell(one, Twist, "/edgevox/cmd_vel"), twist(0.8, 0.0))
    wait_until(lambda: robot.body.pose().x_m > 2.0, "driving")
    stream.end()
    wait_until(lambda: abs(robot.body.velocity().linear_m_s) < 1e-3, "standing")
    robot.body.reset()
    seen = len(tf.messages)
    wait_until(lambda: len(tf.messages) > seen + 5, "more transforms")
    chain = links(tf.messages[-1])
    above, below = chain["map", "odom"], chain["odom", "base_link"]
    assert below.translation.x > 1.0, "odom must not jump back"
    turn = yaw(above.rotation)
    x = above.translation.x + below.translation.x * math.cos(turn)
    y = above.translation.y + below.translation.x * math.sin(turn)
    assert (x, y) == (pytest.approx(1.0, abs=0.02), pytest.approx(2.0, abs=0.02))
    ways = [m.pose.pose.position.x for m in list(odom.messages)]
    assert max(abs(b - a) for a, b in itertools.pairwise(ways)) < 0.8, "and has not"


def test_a_prefix_is_on_every_frame_but_map(offer, peer):
    offer(odom_frame="odom", frame_prefix="robot1/")
    one = peer()
    heard = hear(one, TFMessage, "/tf").wait_for(lambda m: True)
    assert set(links(heard)) == {("map", "robot1/odom"), ("robot1/odom", "robot1/base_link")}
    static = hear(one, TFMessage, "/tf_static", STATE).wait_for(lambda m: True)
    assert set(links(static)) == {("robot1/base_link", "robot1/lidar_link")}
    pose = hear(one, PoseStamped, "/edgevox/pose").wait_for(lambda m: True)
    assert pose.header.frame_id == "map"
    odom = hear(one, Odometry, "/edgevox/odom").wait_for(lambda m: True)
    assert (odom.header.frame_id, odom.child_frame_id) == ("robot1/odom", "robot1/base_link")


def test_publish_clock_makes_stamps_the_bodys_time_for_peers_with_sim_time(offer, peer):
    offer(publish_clock=True)
    one = peer()
    one.node.set_parameters([Parameter("use_sim_time", value=True)])
    clock = hear(one, Clock, "/clock", SENSOR)
    pose = hear(one, PoseStamped, "/edgevox/pose")
    stamp = seconds(pose.wait_for(lambda m: True).header.stamp)
    assert stamp < 60
    clock.wait_for(lambda m: seconds(m.clock) >= stamp)
    wait_until(lambda: one.node.get_clock().now().nanoseconds > stamp * 1e9, "sim time")
    assert one.node.get_clock().now().nanoseconds < 60e9


def test_with_use_sim_time_nothing_is_stamped_until_there_is_a_clock(offer, peer):
    robot = offer(ros_args=("--ros-args", "-p", "use_sim_time:=true"))
    one = peer()
    pose = hear(one, PoseStamped, "/edgevox/pose")
    tick = tell(one, Clock, "/clock", SENSOR)
    begun = robot.body.time_s
    wait_until(lambda: robot.body.time_s > begun + 0.3, "some time without a clock")
    assert not pose.messages
    now = Clock()
    now.clock.sec = 1000
    stream = Stream(tick, now)
    stamp = pose.wait_for(lambda m: True).header.stamp
    stream.end()
    assert seconds(stamp) == 1000
