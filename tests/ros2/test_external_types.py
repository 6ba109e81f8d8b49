"""A robot's drivers decide the types of its topics: EdgeVox follows them, or says what is there."""

import contextlib
import math
import subprocess
import sys

import numpy as np
import pytest
from external_rig import drive, heard, moving, robot_process, standing
from peer import Peer
from waiting import wait_until

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.languages import LANGUAGES
from edgevox.core.status import Level
from edgevox.robots.sim_loop import SimComponent
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import ExternalSettings, Patience, SteeringLimits

QUICK = ExternalSettings(
    steering=SteeringLimits(max_linear_m_s=0.6, max_angular_rad_s=1.5, wait_s=1.0),
    steering_patience=Patience(unmoved_s=3.0, no_nearer_s=10.0),
    obey_s=3.0,
)
FAR_M = 50.0


class Rig:
    """A robot of these types, a body that drives it, and what the robot took."""

    def __init__(self, process: subprocess.Popen[str], robot: ExternalRobot, peer: Peer) -> None:
        self.process, self.robot = process, robot
        self.taken = peer.listen("taken")

    def restart_driver_with(self, type_: str) -> None:
        self.process.stdin.write(f"{type_}\n")
        self.process.stdin.flush()

    def until_taken(self, start: str, since: int | None = None) -> str:
        since = len(self.taken.messages) if since is None else since
        return self.taken.wait_for(lambda m: m.startswith(start), since=since)


@pytest.fixture
def rig(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with contextlib.ExitStack() as stack:

        def start(*arguments: str, located: bool = True) -> Rig:
            process = robot_process(
                "typed_robot.py", *arguments, domain=domain, namespace="/robot1"
            )
            robot = ExternalRobot("/robot1", {}, QUICK)
            stack.callback(robot.close)
            robot.start()
            peer = stack.enter_context(contextlib.closing(Peer(domain, "/robot1")))
            one = Rig(stack.enter_context(process), robot, peer)
            if located:
                heard(robot)
            return one

        yield start


def test_a_robot_that_takes_stamped_velocities_drives_and_stops_whatever_its_clock_says(rig):
    one = rig("--cmd-vel", "TwistStamped", "--ahead", "1000")

    drive(one.robot, 0.4, 0.0).result()
    assert math.hypot(one.robot.pose().x_m - 0.4, one.robot.pose().y_m) < 0.2

    going = drive(one.robot, FAR_M, 0.0)
    moving(one.robot)
    one.robot.halt("a test")
    assert one.until_taken("TwistStamped 0.00 0.00") == "TwistStamped 0.00 0.00 base_link"
    standing(one.robot)
    with pytest.raises(Exception, match="a test"):
        going.result()


def test_a_driver_that_restarts_with_another_type_is_driven_on_and_stopped_in_that_type(rig):
    one = rig("--cmd-vel", "Twist")
    going = drive(one.robot, FAR_M, 0.0)
    one.until_taken("Twist 0.6")

    one.restart_driver_with("TwistStamped")
    one.until_taken("TwistStamped 0.6")
    one.restart_driver_with("Twist")
    one.until_taken("Twist 0.6")

    one.robot.halt("a test")
    one.until_taken("Twist 0.00 0.00")
    standing(one.robot)
    with pytest.raises(Exception, match="a test"):
        going.result()


def test_while_both_types_are_there_each_has_the_velocities_and_the_stop(rig, domain):
    one = rig("--cmd-vel", "Twist")
    going = drive(one.robot, FAR_M, 0.0)
    one.until_taken("Twist 0.6")

    other = robot_process(
        "typed_robot.py", "--cmd-vel=TwistStamped", "--odom=", domain=domain, namespace="/robot1"
    )
    with other:
        one.until_taken("TwistStamped 0.6")
        one.until_taken("Twist 0.6")
        told = "/robot1/cmd_vel has the types geometry_msgs/msg/Twist and geometry_msgs/msg/Twist"
        assert [doubt.startswith(told) for doubt in one.robot.doubts] == [True]
        since = len(one.taken.messages)
        one.robot.halt("a test")
        for kind in ("Twist", "TwistStamped"):
            one.until_taken(f"{kind} 0.00 0.00", since)
        standing(one.robot)
    with pytest.raises(Exception, match="a test"):
        going.result()


def test_a_type_that_edgevox_cannot_send_is_named_and_nothing_is_driven(rig):
    one = rig("--cmd-vel", "Float32")
    told = (
        "/robot1/cmd_vel has the type std_msgs/msg/Float32, and not"
        " geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped"
    )
    wait_until(lambda: one.robot.doubts, "the type")

    for motion in (
        lambda: drive(one.robot, 1.0, 0.0).result(),
        lambda: one.robot.turn(1.0, token=drive(one.robot, 0.0, 0.0).token, report=dict),
    ):
        with pytest.raises(SkillFailed) as failed:
            motion()
        assert str(failed.value) == told
    for language in LANGUAGES:
        said = phrasebook(language).failure(failed.value.reason)
        assert "Float32" in said
        assert "TwistStamped" in said
    status = SimComponent(one.robot).status()
    assert status.level is Level.WARN
    assert told in status.message


def test_a_drive_says_at_once_that_nothing_takes_velocities_and_where_something_does(rig):
    one = rig("--ros-args", "-r", "cmd_vel:=base/cmd_vel")

    with pytest.raises(SkillFailed) as failed:
        drive(one.robot, 1.0, 0.0).result()

    unheard = because("velocities_unheard", topic="/robot1/cmd_vel")
    assert str(failed.value).startswith(unheard.text)
    assert "/robot1/base/cmd_vel (geometry_msgs/msg/Twist)" in str(failed.value)


def test_a_quality_of_service_that_lets_nothing_through_is_told_and_nothing_is_driven(rig):
    one = rig("--latched")
    barrier = "volatile publisher and transient local subscription"
    told = f"nothing gets through on /robot1/cmd_vel: {barrier}"
    wait_until(lambda: one.robot.doubts == [told], told)

    with pytest.raises(SkillFailed) as failed:
        drive(one.robot, 1.0, 0.0).result()

    assert str(failed.value).endswith(f"({barrier})")


def test_its_node_stays_with_the_robot_whatever_the_agents_node_is_called(rig, monkeypatch):
    names = ["--ros-args", "-r", "__ns:=/elsewhere", "-r", "__node:=agent"]
    monkeypatch.setattr(sys, "argv", [*sys.argv, *names])
    one = rig()
    drive(one.robot, 0.2, 0.0).result()


@pytest.mark.parametrize(
    ("odom", "told"),
    [
        ("platform/odom", "there is /robot1/platform/odom (nav_msgs/msg/Odometry)"),
        ("PoseStamped", "/robot1/odom has the type geometry_msgs/msg/PoseStamped, and not"),
    ],
)
def test_odometry_of_another_name_or_type_is_named(rig, odom, told):
    one = rig("--odom", odom, located=False)

    wait_until(lambda: told in one.robot.fault, told)

    with pytest.raises(SkillFailed) as failed:
        drive(one.robot, 1.0, 0.0).result()
    assert told in str(failed.value)


def test_a_wall_in_a_point_cloud_makes_it_wait(rig):
    one = rig("--scan", "0.45")
    wait_until(lambda: one.robot.state()["lidar"], "the point cloud")

    with pytest.raises(SkillFailed) as failed:
        drive(one.robot, 2.0, 0.0).result()

    assert str(failed.value) == because("in_my_way").text


def test_the_floor_in_a_point_cloud_is_no_obstacle(rig):
    one = rig("--scan", "5.0")
    wait_until(lambda: one.robot.state()["lidar"], "the point cloud")

    drive(one.robot, 0.4, 0.0).result()


def test_a_compressed_picture_is_shown(rig):
    one = rig("--camera")
    wait_until(lambda: one.robot.state()["camera"], "a picture")

    picture = one.robot.newest_picture()

    assert picture.shape == (16, 32, 3)
    assert (picture == np.array([200, 10, 20])).all()
