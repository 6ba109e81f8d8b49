"""A robot whose word cannot be true is not driven by it, and is driven again when it can."""

import contextlib
import json
import math

import phrases
import pytest
import scraper
from diagnostic_msgs.msg import DiagnosticArray
from external_rig import Velocities, drive, heard, moving, standing, wheels
from geometry_msgs.msg import PoseStamped
from guards import HUNG_S
from interop_rig import hear
from peer import STATE
from ports import free_port
from waiting import wait_until

from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import Refusal
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import ExternalSettings, Patience, SteeringLimits

pytestmark = pytest.mark.long

ODOM = phrases.because("incredible", topic="/robot1/odom")
QUICK = ExternalSettings(
    steering=SteeringLimits(max_linear_m_s=0.6, max_angular_rad_s=1.5, wait_s=1.0),
    steering_patience=Patience(unmoved_s=2.0, no_nearer_s=4.0),
    obey_s=2.5,
)
ON_THEIR_WAY = 100
"""So many velocities wait for a peer that is late; more were not asked for before it stopped."""
NOT_SO = ("claim 1e300", "claim -10001", "claim nan", "length 3")


class Rig:
    """A robot in a process of its own, a body that drives it, and what it was asked for."""

    def __init__(self, robot: ExternalRobot, control, asked: Velocities) -> None:
        self.robot, self.asked, self._control = robot, asked, control

    def tell(self, lie: str) -> None:
        """Have the robot change."""
        self._control.send("do", lie)

    def stands(self) -> None:
        """Soon nothing but zero velocity is asked for; what was on its way may still come."""
        heard, since = self.asked.heard, len(self.asked.heard)
        wait_until(lambda: (0.0, 0.0) in heard[since:], "a zero")
        begin = heard.index((0.0, 0.0), since)
        assert begin - since <= ON_THEIR_WAY
        wait_until(lambda: len(heard) >= begin + 5, "a stream of zeros")
        assert set(heard[begin:]) == {(0.0, 0.0)}


@pytest.fixture
def rig(domain, monkeypatch, peer):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with contextlib.ExitStack() as stack:

        def start(*arguments: str) -> Rig:
            stack.enter_context(wheels(*arguments, domain=domain, namespace="/robot1"))
            robot = ExternalRobot("/robot1", settings=QUICK)
            stack.callback(robot.close)
            robot.start()
            heard(robot)
            control = peer("/robot1")
            return Rig(robot, control, Velocities(control, "/robot1/cmd_vel"))

        yield start


@pytest.mark.parametrize("lie", NOT_SO)
def test_odometry_that_cannot_be_true_stops_the_drive_and_says_why(rig, lie, caplog):
    one = rig()
    going = drive(one.robot, 5.0, 0.0)
    moving(one.robot)
    one.tell(lie)
    with pytest.raises(SkillFailed, check=ODOM):
        going.result()
    one.stands()
    assert "odometry_impossible topic='/robot1/odom'" in caplog.text
    assert one.robot.fault == "what is heard on /robot1/odom cannot be true"
    assert one.robot.state()["pose"] is None
    assert one.robot.refusals["/robot1/odom", Refusal.IMPLAUSIBLE] > 0


def test_a_robot_that_lies_is_not_driven_and_one_that_stops_lying_is(rig):
    one = rig()
    one.tell("claim 1e300")
    wait_until(lambda: one.robot.fault, "the lie")
    with pytest.raises(SkillFailed, check=ODOM):
        drive(one.robot, 1.0, 0.0).result()
    assert one.asked.moving == []
    one.tell("truth")
    wait_until(lambda: not one.robot.fault, "the truth")
    drive(one.robot, 0.5, 0.0).result()


@pytest.mark.parametrize("metres", [5, -3])
def test_a_jump_stops_the_drive_and_the_next_goal_is_driven_from_the_new_pose(rig, metres):
    one = rig()
    going = drive(one.robot, 4.0, 0.0)
    moving(one.robot)
    one.tell(f"jump {metres}")
    with pytest.raises(SkillFailed, check=phrases.because("jumped", degrees="0")) as failed:
        going.result()
    assert float(failed.value.reason.values["distance"]) // 1 == abs(metres)
    one.stands()
    standing(one.robot)
    assert one.robot.fault == ""
    at = one.robot.pose()
    drive(one.robot, at.x_m + 0.4, at.y_m).result()
    assert math.hypot(one.robot.pose().x_m - at.x_m - 0.4, one.robot.pose().y_m - at.y_m) < 0.12


def test_a_jump_while_nothing_drives_is_only_where_the_robot_is(rig):
    one = rig()
    one.tell("jump 50")
    wait_until(lambda: one.robot.pose().x_m > 49, "the new pose")
    drive(one.robot, 50.4, 0.0).result()


def test_a_robot_that_takes_goals_gets_its_own_place_as_its_goal_when_it_jumps(rig, peer):
    one = rig("--takes-goals")
    goals = hear(peer(), PoseStamped, "/robot1/goal_pose")
    going = drive(one.robot, 5.0, 0.0)
    moving(one.robot)
    one.tell("jump 5")
    with pytest.raises(SkillFailed, check=phrases.because("jumped")):
        going.result()
    recalled = goals.wait_for(lambda m: m.pose.position.x != 5.0)
    assert recalled.pose.position.x == pytest.approx(one.robot.pose().x_m, abs=1.0)


def test_localisation_may_correct_a_robot_by_metres_while_it_drives(rig):
    one = rig("--map-to-odom", "3,-2,0", "--start", "3,-2,0")
    wait_until(lambda: one.robot.state()["frame"] == "map", "the transform")
    going = drive(one.robot, 6.0, -2.0)
    moving(one.robot)
    one.tell("correct 1.5")
    going.result()
    assert abs(one.robot.pose().x_m - 6.0) < 0.12


@pytest.mark.parametrize(
    ("metres", "reason"),
    [
        (100, phrases.because("jumped", distance="100.0")),
        (20_000, phrases.because("incredible", topic="/tf")),
    ],
)
def test_a_correction_beyond_all_measure_stops_the_drive(rig, metres, reason):
    one = rig("--map-to-odom", "3,-2,0", "--start", "3,-2,0")
    wait_until(lambda: one.robot.state()["frame"] == "map", "the transform")
    going = drive(one.robot, 6.0, -2.0)
    moving(one.robot)
    one.tell(f"correct {metres}")
    with pytest.raises(SkillFailed, check=reason):
        going.result()
    one.stands()


def test_a_transform_that_can_be_none_moves_nobody(rig):
    one = rig("--map-to-odom", "3,-2,0", "--start", "3,-2,0")
    wait_until(lambda: one.robot.state()["frame"] == "map", "the transform")
    one.tell("correct 1e300")
    wait_until(lambda: one.robot.refusals["/tf", Refusal.IMPLAUSIBLE] == 1, "the transform")
    assert one.robot.pose().x_m == pytest.approx(3.0, abs=0.01)


def test_nobody_is_steered_by_a_lidar_that_cannot_see(rig):
    one = rig("--scan")
    wait_until(lambda: one.robot.state()["lidar"], "a scan")
    going = drive(one.robot, 5.0, 0.0)
    moving(one.robot)
    one.tell("blind")
    with pytest.raises(SkillFailed, check=phrases.because("incredible", topic="/robot1/scan")):
        going.result()
    one.stands()
    one.tell("sighted")
    wait_until(lambda: one.robot.state()["lidar"], "a scan")
    standing(one.robot)
    at = one.robot.pose()
    drive(one.robot, at.x_m + 0.3, at.y_m).result()


def test_a_robot_that_only_turns_is_given_up_and_stands(rig):
    one = rig()
    one.tell("spinning")
    going = drive(one.robot, 3.0, 0.0)
    with pytest.raises(SkillFailed, check=phrases.because("not_closer")):
        going.result(20)
    one.stands()
    standing(one.robot)


def test_an_agent_says_so_to_people_and_to_operators(agent, peer, domain):
    with wheels(domain=domain, namespace="/robot1"):
        port = free_port()
        agent(
            "--namespace=/robot1", "--language=de", f"--metrics-port={port}",
            robot="robot-external",
        )  # fmt: skip
        control, one = peer("/robot1"), peer()
        state = one.listen("robot_state", STATE)
        response = one.listen("response")
        told = hear(one, DiagnosticArray, "/diagnostics")
        state.wait_for(lambda m: json.loads(m)["pose"] is not None)
        one.send("text_input", "fahr zu x 5, y 0")
        state.wait_for(
            lambda m: (json.loads(m)["velocity"] or {}).get("linear", 0) > 0.05, timeout_s=HUNG_S
        )
        control.send("do", "claim 1e300")
        response.wait_for(lambda m: "was der Roboter meldet, kann nicht stimmen" in m)
        reason = "what is heard on /robot1/odom cannot be true"
        told.wait_for(lambda m: any(reason in s.message for s in m.status))
        refused = ("edgevox_refused_messages_total", "implausible", "/robot1/odom")
        scraper.scrape_until(port, lambda found: found.get(refused, 0) > 0)
