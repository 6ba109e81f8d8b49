"""The robot's standard topics, with the agent in a process of its own."""

import json

import pytest
from agent_process import AGENT
from geometry_msgs.msg import PoseStamped, Twist
from guards import run_program
from interop_rig import Stream, hear, tell, twist
from peer import SENSOR, STATE
from robot_states import far_room, standing
from rosgraph_msgs.msg import Clock
from waiting import wait_until

from edgevox.ros2.stamps import to_ns
from tf2_msgs.msg import TFMessage

STEP_NS = 20_000_000


def goal(frame, x, y):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = x, y
    return message


def is_kind(kind, status):
    return lambda m: json.loads(m)["kind"] == kind and json.loads(m).get("status") == status


def test_a_velocity_takes_over_from_a_sentence_and_the_goal_ends_as_cancelled(robot):
    agent_event = robot.listen("agent_event")
    robot_state = robot.listen("robot_state", STATE)
    steer = tell(robot, Twist, "/edgevox/cmd_vel")
    robot.send("text_input", f"go to the {far_room(robot_state.wait_for(standing))}")
    robot_state.wait_for(lambda m: json.loads(m)["velocity"]["linear"] > 0.05)
    stream = Stream(steer, twist(0.0, 0.4))
    cancelled = agent_event.wait_for(is_kind("skill_cancelled", "cancelled"))
    assert json.loads(cancelled)["reason"] == "somebody else steers"
    robot_state.wait_for(lambda m: json.loads(m)["velocity"]["angular"] > 0.35)
    stream.end()
    robot_state.wait_for(standing, since=len(robot_state.messages))


def test_a_goal_pose_is_a_goal_like_any_other(robot):
    agent_event = robot.listen("agent_event")
    say = tell(robot, PoseStamped, "/edgevox/goal_pose")
    here = hear(robot, PoseStamped, "/edgevox/pose").wait_for(lambda m: True).pose.position
    say(goal("base_link", 0.4, 0.0))
    agent_event.wait_for(is_kind("skill_goal", "succeeded"))
    arrived = hear(robot, PoseStamped, "/edgevox/pose").wait_for(lambda m: True).pose.position
    away = ((arrived.x - here.x) ** 2 + (arrived.y - here.y) ** 2) ** 0.5
    assert away == pytest.approx(0.4, abs=0.15)


@pytest.mark.parametrize("far", [50.0, 1e9, 1e308])
def test_a_goal_pose_outside_the_world_is_refused_and_the_robot_stands(resident, robot, far):
    agent_event = robot.listen("agent_event")
    robot_state = robot.listen("robot_state", STATE)
    lines = len(resident.lines)
    tell(robot, PoseStamped, "/edgevox/goal_pose")(goal("map", far, 2.0))
    line = resident.wait_for_line("goal_pose_refused", since=lines)
    assert "That point is outside the apartment: x must be between 0 and 10" in line
    robot_state.wait_for(standing, since=len(robot_state.messages))
    agent_event.wait_for(lambda said: json.loads(said)["status"] == "rejected")
    assert len(agent_event.messages) == 1, "no call, and one refusal"


def test_a_goal_whose_quaternion_is_all_zero_is_refused(resident, robot):
    lines = len(resident.lines)
    lost = goal("map", 1.0, 1.0)
    lost.pose.orientation.w = 0.0
    tell(robot, PoseStamped, "/edgevox/goal_pose")(lost)
    line = resident.wait_for_line("goal_pose_refused", since=lines)
    assert "expected a quaternion of length 1" in line


def test_a_goal_in_an_unknown_frame_is_refused_in_a_line_that_says_why(resident, robot):
    agent_event = robot.listen("agent_event")
    lines = len(resident.lines)
    tell(robot, PoseStamped, "/edgevox/goal_pose")(goal("moon", 1.0, 1.0))
    line = resident.wait_for_line("goal_pose_refused", since=lines)
    assert "frame_id: got 'moon', expected one of map, base_link" in line
    assert not agent_event.messages


@pytest.mark.parametrize("parameter", ["frame_prefix:=/robot1", "odom_frame:=base_link"])
def test_a_frame_that_cannot_be_ends_the_process_with_its_reason(domain, parameter):
    bad = run_program(
        [
            AGENT,
            "robot-apartment",
            "--text-mode",
            "--ros2",
            "--llm=none",
            "--ros-args",
            "-p",
            parameter,
        ]
    )
    assert bad.returncode == 1
    assert f"{parameter.partition(':')[0]}: got" in bad.stderr


def frames(tf, number):
    """The parents of this many frames."""
    parents: dict[str, set[str]] = {}

    def complete():
        for message in list(tf.messages):
            for link in message.transforms:
                parents.setdefault(link.child_frame_id, set()).add(link.header.frame_id)
        return len(parents) == number

    wait_until(complete, "both robots")
    return parents


def test_two_robots_on_one_domain_stay_apart_and_time_is_on_clock_only_where_it_is_asked_for(
    agent, peer
):
    names = ("robot1", "robot2")
    apart = {
        name: ("--ros-args", "-p", "odom_frame:=odom", "-p", f"frame_prefix:={name}/")
        for name in names
    }
    agent("--ros2-namespace", "/robot1", *apart["robot1"])
    one, two = peer("/robot1"), peer("/robot2")
    hear(one, PoseStamped, "/robot1/pose").wait_for(lambda m: True)
    assert one.node.count_publishers("/clock") == 0

    agent("--ros2-namespace", "/robot2", *apart["robot2"], "-p", "publish_clock:=true")
    assert frames(hear(one, TFMessage, "/tf"), 4) == {
        "robot1/odom": {"map"},
        "robot2/odom": {"map"},
        "robot1/base_link": {"robot1/odom"},
        "robot2/base_link": {"robot2/odom"},
    }

    heard_one, heard_two = one.listen("response"), two.listen("response")
    one.send("text_input", "where are you")
    heard_one.wait_for(lambda m: m.startswith("I am in"))
    two.send("text_input", "what is your battery")
    heard_two.wait_for(lambda m: "%" in m or "percent" in m)
    assert len(heard_one.messages) == 1

    clock = hear(one, Clock, "/clock", SENSOR)
    pose = hear(one, PoseStamped, "/robot2/pose")
    clock.wait_for_more(20)
    steps = [to_ns(m.clock) / STEP_NS for m in list(clock.messages)]
    assert all(step.is_integer() for step in steps), "the robot's time has 50 steps a second"
    assert steps == sorted(set(steps)), "and each is said once"
    stamp = pose.wait_for(lambda m: True).header.stamp
    assert 0 <= clock.messages[-1].clock.sec - stamp.sec < 30, "stamps are of that time"
