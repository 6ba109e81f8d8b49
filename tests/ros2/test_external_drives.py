"""A robot that knows only standard topics is driven there, between two processes."""

import contextlib
import math
import threading
from concurrent.futures import ThreadPoolExecutor

import phrases
import pytest
from external_rig import (
    Drive,
    Goal,
    Velocities,
    drive,
    drive_to_place,
    heard,
    moving,
    standing,
    wheels,
)
from guards import HUNG_S
from interop_rig import hear, tell
from peer import SENSOR, Peer
from rclpy.action import ActionClient, ActionServer, CancelResponse
from sensor_msgs.msg import Image, LaserScan
from support.clock import HeldClock
from waiting import wait_until

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled
from edgevox.core.clock import Clock
from edgevox.core.transforms import Pose2D, rotate
from edgevox.robots.capabilities import Twist2D
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import ExternalSettings, Location, Patience, SteeringLimits
from edgevox.ros2.stamps import NS_PER_S, to_ns
from edgevox_msgs.action import ExecuteSkill

LOCATIONS = {"dock": Location(0.0, 0.0, math.pi), "desk": Location(1.0, 0.6, math.pi / 2)}
QUICK = ExternalSettings(
    steering=SteeringLimits(max_linear_m_s=0.6, max_angular_rad_s=1.5, wait_s=1.0),
    steering_patience=Patience(unmoved_s=2.0, no_nearer_s=10.0),
    goal_patience=Patience(unmoved_s=3.0, no_nearer_s=20.0),
    obey_s=2.5,
)


AGAIN_S = 2.0
TAKES_GOALS = ("--takes-goals", "--reliability", "reliable")
MAPPED = ("--map-to-odom", "3,-2,1.2", "--start", "1,1,0")


class Wheels:
    """A robot that runs on from test to test, for as long as it is wanted with these arguments."""

    def __init__(self, domain: int, peer: Peer) -> None:
        self._domain, self._peer = domain, peer
        self._running, self._arguments = contextlib.ExitStack(), None

    def run(self, *arguments: str) -> None:
        """It runs, as it was at its start."""
        if arguments != self._arguments:
            self.close()
            self._running.enter_context(
                wheels(*arguments, domain=self._domain, namespace="/robot1")
            )
            self._arguments = arguments
            self._done = self._peer.listen("done")
        # It may know of who says that later than that knows of it: the first is lost then.
        for again in range(int(HUNG_S / AGAIN_S)):
            since = len(self._done.messages)
            self._peer.send("do", f"anew {again}")
            with contextlib.suppress(AssertionError):
                self._done.wait_for(lambda m: m == f"anew {again}", AGAIN_S, since)  # noqa: B023
                return
        pytest.fail("it is not as at its start")

    def close(self) -> None:
        self._running.close()
        self._arguments = None


@pytest.fixture(scope="module")
def control(domain):
    """The peer of all tests: to discover one anew takes seconds."""
    with contextlib.closing(Peer(domain, "/robot1")) as one:
        yield one


@pytest.fixture(scope="module")
def _wheels(domain, control):
    with contextlib.closing(Wheels(domain, control)) as one:
        yield one


@pytest.fixture
def rig(_wheels, domain, monkeypatch):
    """Has a robot run, and a body for it; ends the body."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with contextlib.ExitStack() as stack:

        def start(
            *arguments: str, namespace: str = "/robot1", clock: Clock | None = None
        ) -> ExternalRobot:
            if namespace == "/robot1":
                _wheels.run(*arguments)
            else:
                stack.enter_context(wheels(*arguments, domain=domain, namespace=namespace))
            robot = ExternalRobot(namespace, LOCATIONS, QUICK, clock=clock)
            stack.callback(robot.close)
            robot.start()
            heard(robot)
            return robot

        yield start


def distance(robot: ExternalRobot, x_m: float, y_m: float) -> float:
    pose = robot.pose()
    return math.hypot(pose.x_m - x_m, pose.y_m - y_m)


def test_a_robot_that_takes_no_goals_is_steered_to_a_location_and_looks_as_it_says(rig, control):
    robot = rig()
    asked = Velocities(control, "/robot1/cmd_vel")

    drive_to_desk = drive_to_place(robot, "desk")
    moving(robot)
    assert robot.state()["goal"]["by"] == "cmd_vel"
    drive_to_desk.result()

    assert distance(robot, 1.0, 0.6) < 0.12
    assert robot.pose().yaw_rad == pytest.approx(math.pi / 2, abs=0.12)
    assert robot.state()["location"] == "desk"
    assert robot.state()["goal"] is None
    assert drive_to_desk.reports[-1]["progress"] == 1.0
    assert max(abs(linear) for linear, _ in asked.moving) <= 0.6
    assert max(abs(angular) for _, angular in asked.moving) <= 1.5


def test_a_robot_is_steered_no_faster_than_somebody_else_permits(rig, control):
    robot = rig()
    robot.limit_speed(lambda twist: Twist2D(twist.linear_m_s / 3, twist.angular_rad_s / 3))
    asked = Velocities(control, "/robot1/cmd_vel")
    drive(robot, 0.8, 0.0).result()
    assert distance(robot, 0.8, 0.0) < 0.12
    assert 0.1 < max(abs(linear) for linear, _ in asked.moving) <= 0.2 + 1e-9
    assert max(abs(angular) for _, angular in asked.moving) <= 0.5 + 1e-9


def test_a_halt_does_not_block_and_stands_a_steered_robot(rig):
    robot = rig()
    going = drive(robot, 5.0, 0.0)
    moving(robot)
    assert robot.halt("a test") is True
    with pytest.raises(Cancelled, match="a test"):
        going.result()
    standing(robot, 3.0)
    assert robot.pose().x_m < 4.0


def test_a_cancelled_token_ends_the_drive_and_stands_the_robot(rig):
    robot = rig()
    going = drive(robot, 5.0, 0.0)
    moving(robot)
    going.token.cancel("changed my mind")
    with pytest.raises(Cancelled, match="changed my mind"):
        going.result()
    standing(robot, 3.0)


def test_a_new_goal_ends_the_one_before(rig):
    robot = rig()
    first = drive(robot, 5.0, 0.0)
    moving(robot)
    second = drive(robot, 0.0, 0.5)
    with pytest.raises(Cancelled, match="a new goal came"):
        first.result()
    second.result()
    assert distance(robot, 0.0, 0.5) < 0.12


def test_a_robot_that_does_not_obey_is_said_not_to(rig, control, caplog):
    robot = rig()
    control.send("do", "runaway")
    moving(robot)
    with pytest.raises(SkillFailed, check=phrases.because("still_moves")):
        {one.name: one for one in robot.skills}["stop"].function(Goal())
    assert "it still moves" in caplog.text


def test_a_robot_that_is_stuck_fails_its_goal_with_a_reason(rig, control):
    robot = rig()
    control.send("do", "stuck")
    going = drive(robot, 2.0, 0.0)
    with pytest.raises(SkillFailed, check=phrases.because("not_moving")):
        going.result()


def test_a_drive_begins_once_a_robot_that_was_silent_for_a_moment_is_heard(rig, control):
    clock = HeldClock()
    robot = rig(clock=clock)
    control.send("do", "silent")

    def silent() -> bool:
        clock.advance(QUICK.discovery_s + 1.0)
        return robot.state()["pose"] is None

    wait_until(silent, "silence")

    going = drive(robot, 5.0, 0.0)
    control.send("do", "heard")

    wait_until(lambda: robot.state()["goal"], "the drive")
    robot.halt("a test")
    with pytest.raises(Cancelled, match="a test"):
        going.result()


def test_silent_odometry_stops_the_robot_and_is_said(rig, control, caplog):
    robot = rig()
    asked = Velocities(control, "/robot1/cmd_vel")
    going = drive(robot, 5.0, 0.0)
    moving(robot)
    control.send("do", "silent")
    with pytest.raises(SkillFailed, check=phrases.because("robot_silent", topic="/robot1/odom")):
        going.result()
    wait_until(lambda: asked.heard[-3:] == [(0.0, 0.0)] * 3, "zero velocity")
    wait_until(lambda: "odometry_silent topic='/robot1/odom'" in caplog.text, "the log line")
    with pytest.raises(SkillFailed, check=phrases.because("lost")):
        robot.pose()
    state = robot.state()
    assert state["pose"] is None
    assert state["odom_age"] > 1.0
    control.send("do", "heard")
    heard(robot)
    standing(robot)


def test_a_camera_is_heard_and_its_pictures_are_for_whoever_looks(rig, control):
    robot = rig()
    assert robot.state()["camera"] is False
    assert robot.newest_picture() is None
    red = Image(encoding="bgr8", height=1, width=1, step=3, data=b"\x01\x02\xff")
    seen = []

    def look():
        say(red)
        seen.append(robot.newest_picture())
        return robot.state()["camera"] and seen[-1] is not None

    say = tell(control, Image, "/robot1/camera/image_raw", SENSOR)
    wait_until(look, "a picture")
    assert seen[-1].tolist() == [[[255, 2, 1]]]
    wait_until(lambda: not robot.state()["camera"], "a second without one")
    assert robot.newest_picture() is None


@pytest.mark.long
def test_odometry_is_taken_for_the_map_where_no_transform_says_better(rig, caplog):
    robot = rig()
    drive(robot, 0.3, 0.0).result()
    drive(robot, 0.0, 0.0).result()
    said = [r for r in caplog.records if "frame_taken_for_map" in r.message]
    assert len(said) == 1


def test_closing_leaves_the_robot_standing(rig, control):
    robot = rig()
    asked = Velocities(control, "/robot1/cmd_vel")
    going = drive(robot, 5.0, 0.0)
    moving(robot)
    robot.close()
    with pytest.raises(Cancelled):
        going.result()
    wait_until(lambda: asked.heard[-1] == (0.0, 0.0), "zero velocity")


def test_a_halt_cancels_the_goals_of_an_action_that_somebody_else_sent(rig, control):
    robot = rig()
    nav2 = control
    accepted, cancelled = threading.Event(), threading.Event()

    def run(goal):
        """Runs until it is cancelled, beside the executor's thread."""
        accepted.set()
        wait_until(lambda: goal.is_cancel_requested, "cancel")
        goal.canceled()
        cancelled.set()
        return ExecuteSkill.Result()

    # Cancelling is the same for every type of action; Nav2's own is not needed for it.
    with ThreadPoolExecutor(1) as pool:
        server = ActionServer(
            nav2.node,
            ExecuteSkill,
            "/robot1/navigate_to_pose",
            lambda _: ExecuteSkill.Result(),
            handle_accepted_callback=lambda goal: pool.submit(run, goal),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        client = ActionClient(nav2.node, ExecuteSkill, "/robot1/navigate_to_pose")
        assert client.wait_for_server(15)
        # The server is asked, not the client: answers get lost while both discover each other.
        client.send_goal_async(ExecuteSkill.Goal(skill_name="drive"))
        assert accepted.wait(HUNG_S)

        def stopped() -> bool:
            """Said again for as long as the robot has not discovered the action."""
            robot.halt("somebody said stop")
            return cancelled.is_set()

        wait_until(stopped, "the end of the goal")
        nav2.there(client.destroy)
        nav2.there(server.destroy)


@pytest.mark.long
def test_robots_in_other_namespaces_are_left_alone(rig, control):
    one = rig(namespace="/robot1")
    two = rig(*TAKES_GOALS, namespace="/robot2")
    for_two = Velocities(control, "/robot2/cmd_vel")
    drive(one, 0.5, 0.0).result()
    assert distance(one, 0.5, 0.0) < 0.12
    assert distance(two, 0.0, 0.0) < 0.01
    assert for_two.heard == []


def test_a_robot_that_takes_goals_gets_one_and_is_never_steered(rig, control):
    robot = rig(*TAKES_GOALS)
    asked = Velocities(control, "/robot1/cmd_vel")

    going = drive_to_place(robot, "desk")
    moving(robot)
    assert robot.state()["goal"]["by"] == "goal_pose"
    going.result()

    assert distance(robot, 1.0, 0.6) < 0.36
    assert asked.heard == []


def test_stop_recalls_the_goal_and_holds_zero_until_the_robot_stands(rig, control):
    robot = rig(*TAKES_GOALS)
    asked = Velocities(control, "/robot1/cmd_vel")
    going = drive(robot, 5.0, 0.0)
    moving(robot)

    stopped = {one.name: one for one in robot.skills}["stop"].function(Goal())

    assert stopped == {"was_moving": True}
    with pytest.raises(Cancelled):
        going.result()
    standing(robot, 1.0)
    assert asked.moving == []
    wait_until(lambda: len(asked.heard) >= 15, "a stream of zeros")
    assert asked.moving == []
    where = robot.pose()
    wait_until(lambda: robot.time_s > 0, "time")
    drive_back = drive(robot, where.x_m, where.y_m)
    drive_back.result()
    assert distance(robot, where.x_m, where.y_m) < 0.36


def test_a_robot_that_takes_goals_but_does_not_go_fails_with_a_reason(rig, control):
    robot = rig(*TAKES_GOALS)
    control.send("do", "stuck")
    with pytest.raises(SkillFailed, check=phrases.because("not_moving")):
        drive(robot, 2.0, 0.0).result()


@pytest.mark.long
def test_something_in_the_way_is_waited_for_and_then_given_up(rig, control):
    robot = rig("--scan")
    scans = hear(control, LaserScan, "/robot1/scan", SENSOR)
    wait_until(lambda: robot.state()["lidar"], "a scan")
    control.send("do", "wall 0.4")
    wall = scans.wait_for(lambda scan: min(scan.ranges) < 1)
    wait_until(lambda: robot.time_s > to_ns(wall.header.stamp) / NS_PER_S + 0.2, "the wall")
    with pytest.raises(SkillFailed, check=phrases.because("in_my_way")):
        drive(robot, 3.0, 0.0).result()
    assert robot.pose().x_m < 0.2
    control.send("do", "wall")
    drive(robot, 0.5, 0.0).result()


@pytest.mark.parametrize(
    ("frame", "arguments"),
    [("odom", ("--scan",)), ("map", ("--scan", *TAKES_GOALS, *MAPPED))],
)
def test_it_goes_by_a_distance_and_an_angle_where_its_lidar_sees(rig, control, frame, arguments):
    robot = rig(*arguments)
    wait_until(lambda: robot.state()["lidar"] and robot.state()["frame"] == frame, "its senses")
    start = robot.pose()

    straight = by(robot.drive_straight, 0.6)
    moving(robot)
    assert robot.state()["goal"]["by"] == "cmd_vel"
    straight.result()
    ahead, aside = seen_from(start, robot.pose())
    assert (ahead, aside) == pytest.approx((0.6, 0.0), abs=0.05)
    assert straight.reports[-1]["unit"] == "m"

    by(robot.turn, -math.pi / 2).result()
    turned = math.remainder(robot.pose().yaw_rad - start.yaw_rad, math.tau)
    assert turned == pytest.approx(-math.pi / 2, abs=0.08)

    with pytest.raises(SkillFailed, check=phrases.because("blind_behind")):
        by(robot.drive_straight, -0.5).result()
    scans = hear(control, LaserScan, "/robot1/scan", SENSOR)
    control.send("do", "wall 0.4")
    wall = scans.wait_for(lambda scan: min(scan.ranges) < 1)
    wait_until(lambda: robot.time_s > to_ns(wall.header.stamp) / NS_PER_S + 0.2, "the wall")
    with pytest.raises(SkillFailed, check=phrases.because("in_my_way")):
        by(robot.drive_straight, 0.5).result()


def by(move, amount: float) -> Drive:
    return Drive(lambda token, report: move(amount, token=token, report=report))


def seen_from(start: Pose2D, pose: Pose2D) -> tuple[float, float]:
    return rotate(pose.x_m - start.x_m, pose.y_m - start.y_m, -start.yaw_rad)


def test_a_stop_ends_a_straight_drive_and_stands_the_robot(rig):
    robot = rig()
    going = by(robot.drive_straight, 5.0)
    moving(robot)
    assert robot.halt("a test") is True
    with pytest.raises(Cancelled, match="a test"):
        going.result()
    standing(robot, 3.0)
    assert robot.pose().x_m < 4.0


def test_what_drives_by_goals_goes_straight_only_where_a_lidar_sees(rig):
    robot = rig(*TAKES_GOALS)
    with pytest.raises(SkillFailed, check=phrases.because("blind_ahead")):
        by(robot.drive_straight, 0.5).result()


@pytest.mark.long
def test_goals_are_compared_in_the_map_where_transforms_join_it_to_odometry(rig):
    robot = rig(*MAPPED, "--frame-prefix", "robot1/")
    wait_until(lambda: robot.state()["frame"] == "map", "the transform")
    pose = robot.pose()
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, 1.0), abs=0.01)
    assert pose.yaw_rad == pytest.approx(0.0, abs=0.01)
    drive(robot, 1.5, 1.3).result()
    assert distance(robot, 1.5, 1.3) < 0.12


@pytest.mark.long
def test_goals_are_sent_in_the_map_where_there_is_one(rig):
    robot = rig(*MAPPED, "--takes-goals")
    wait_until(lambda: robot.state()["frame"] == "map", "the transform")
    drive(robot, 1.5, 1.3).result()
    assert distance(robot, 1.5, 1.3) < 0.36


def test_a_drive_is_refused_while_nothing_was_heard(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    robot = ExternalRobot("/nobody", LOCATIONS, ExternalSettings(discovery_s=0.5))
    robot.start()
    try:
        with pytest.raises(
            SkillFailed, check=phrases.because("robot_unheard", topic="/nobody/odom")
        ):
            drive(robot, 1.0, 0.0).result()
        assert robot.state()["pose"] is None
        assert robot.state()["odom_age"] is None
    finally:
        robot.close()
