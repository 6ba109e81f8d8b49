"""Where Nav2's action is served, drives are its goals, with feedback, results and cancel.

The action is Nav2's, field for field and built here; its server is a stand-in that passes goals on
to a robot that takes them on goal_pose.
"""

import ctypes
import math
import os
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import phrases
import pytest
from external_rig import Velocities, drive, heard, moving, standing, wheels
from geometry_msgs.msg import PoseStamped
from guards import HUNG_S
from interface_overlay import build_overlay, python_packages
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from waiting import wait_until

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled
from edgevox.ros2.external.robot import ExternalRobot


@pytest.fixture(scope="module")
def action(overlays):
    """Nav2's action, importable by this process for as long as the module's tests run."""
    (prefix,) = build_overlay(["nav2_msgs"], overlays)
    for library in (prefix / "lib").glob("*.so"):
        ctypes.CDLL(str(library))  # the path of a running process's libraries is fixed
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AMENT_PREFIX_PATH", f"{prefix}:{os.environ.get('AMENT_PREFIX_PATH', '')}")
        patch.syspath_prepend(str(python_packages(prefix)))
        from nav2_msgs.action import NavigateToPose

        yield NavigateToPose
    for name in [name for name in sys.modules if name.partition(".")[0] == "nav2_msgs"]:
        del sys.modules[name]


class StandIn:
    """Serves the action: passes a goal on and tells how far it is, until the robot is there."""

    def __init__(self, node, action, pool) -> None:
        self.ends: list[str] = []
        self.mode = "serve"
        self._newest = None
        self._action, self._pool = action, pool
        self._goals = node.create_publisher(PoseStamped, "/robot1/goal_pose", 1)
        self.robot: ExternalRobot | None = None
        self._server = ActionServer(
            node,
            action,
            "/robot1/navigate_to_pose",
            self._end,
            handle_accepted_callback=self._accept,
            goal_callback=lambda _: getattr(
                GoalResponse, "REJECT" if self.mode == "reject" else "ACCEPT"
            ),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    @property
    def heard(self) -> bool:
        return self._goals.get_subscription_count() > 0

    def close(self) -> None:
        self._server.destroy()

    def _accept(self, goal) -> None:
        """Drive beside the executor's thread, and have the goal ended on it, as Nav2 does."""
        self._newest = goal
        self._pool.submit(self._drive, goal)

    def _drive(self, goal) -> None:
        end = self._run(goal)
        goal.execute(lambda goal: self._end(goal, end))

    def _end(self, goal, end: str):
        getattr(goal, end)()
        self.ends.append(end)
        return self._action.Result()

    def _run(self, goal) -> str:
        target = goal.request.pose
        self._goals.publish(target)
        pause = threading.Event()
        for _ in range(round(HUNG_S / 0.1)):
            pose, at = self.robot.pose(), target.pose.position
            left_m = math.hypot(pose.x_m - at.x, pose.y_m - at.y)
            if goal.is_cancel_requested:
                return "canceled"
            if self.mode == "abort" or goal is not self._newest:
                return "abort"
            if left_m < 0.1:
                return "succeed"
            told_m = math.nan if self.mode == "nonsense" else left_m
            goal.publish_feedback(self._action.Feedback(distance_remaining=told_m))
            pause.wait(0.1)
        return "abort"


@pytest.fixture
def rig(action, domain, monkeypatch, peer):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    nav2 = peer("/robot1")
    with (
        wheels("--takes-goals", domain=domain, namespace="/robot1"),
        ThreadPoolExecutor() as pool,
    ):
        server = StandIn(nav2.node, action, pool)
        server.robot = robot = ExternalRobot("/robot1")
        robot.start()
        try:
            heard(robot)
            wait_until(lambda: server.heard, "the robot that takes goals")
            yield robot, server, Velocities(nav2, "/robot1/cmd_vel")
        finally:
            server.mode = "abort"
            robot.close()
            nav2.there(server.close)


def test_a_drive_is_a_goal_of_the_action_and_never_steered(rig):
    robot, server, asked = rig
    going = drive(robot, 1.0, 0.5)
    moving(robot)
    assert robot.state()["goal"]["by"] == "navigate_to_pose"
    going.result()
    assert server.ends == ["succeed"]
    assert asked.heard == []
    assert 0 < going.reports[-2]["progress"] < 1
    assert going.reports[-1]["progress"] == 1


def test_a_cancel_reaches_the_server_and_the_robot_stands(rig):
    robot, server, asked = rig
    going = drive(robot, 5.0, 0.0)
    moving(robot)
    going.token.cancel("changed my mind")
    with pytest.raises(Cancelled, match="changed my mind"):
        going.result()
    wait_until(lambda: server.ends == ["canceled"], "the cancel")
    standing(robot)
    assert asked.moving == []


def test_a_new_goal_pre_empts_the_one_before_and_is_reached(rig):
    robot, server, _ = rig
    first = drive(robot, 5.0, 0.0)
    moving(robot)
    second = drive(robot, 0.5, 0.5)
    with pytest.raises(Cancelled, match="a new goal came"):
        first.result()
    second.result()
    assert server.ends == ["abort", "succeed"]


def test_a_goal_right_after_a_cancel_is_not_cancelled_with_it(rig):
    robot, server, _ = rig
    first = drive(robot, 5.0, 0.0)
    moving(robot)
    first.token.cancel("something better came")
    drive(robot, 0.5, 0.5).result()
    assert server.ends == ["canceled", "succeed"]


@pytest.mark.parametrize(
    ("mode", "reason"),
    [("reject", "nav2_refused"), ("abort", "nav2_ended")],
)
def test_a_goal_that_nav2_does_not_reach_fails_with_its_reason(rig, mode, reason):
    robot, server, _ = rig
    server.mode = mode
    with pytest.raises(SkillFailed, check=phrases.because(reason)):
        drive(robot, 2.0, 0.0).result()


def test_a_robot_that_jumps_has_its_goal_cancelled_and_is_driven_again(rig, peer):
    robot, server, asked = rig
    going = drive(robot, 3.0, 3.0)  # not where it jumps to
    moving(robot)
    peer("/robot1").send("do", "jump 5")
    with pytest.raises(SkillFailed, check=phrases.because("jumped", distance="5.0")):
        going.result()
    wait_until(lambda: server.ends == ["canceled"], "the cancel")
    standing(robot)
    assert asked.moving == []


def test_a_way_that_is_left_and_no_number_is_not_believed(rig):
    robot, server, _ = rig
    server.mode = "nonsense"
    going = drive(robot, 0.6, 0.0)
    going.result()
    assert all(0 <= one["distance_m"] < 1 for one in going.reports)
