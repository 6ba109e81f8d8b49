"""Two agents on one namespace: both say so, and only one of them moves the robot."""

import json
import signal
from collections.abc import Callable
from contextlib import suppress

import phrases
import pytest
from action_rig import Client
from agent_process import Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from external_rig import Velocities, wheels
from geometry_msgs.msg import PoseStamped, Twist
from guards import HUNG_S
from interop_rig import Messages, Stream, hear, tell, twist
from nav_msgs.msg import Odometry
from peer import RELIABLE, STATE, Peer
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
from waiting import wait_until

FIRST, SECOND = "base_link", "b_base_link"
"""How the two robots are told apart on the topics that they share."""
AGAIN_S = 5.0
REFUSED = phrases.refused("other_agent")
SENT_M_S = 0.2
TAKES, YIELDS = (f"presence.sharing] in_charge={one}" for one in (True, False))
"""The line that tells who moves the robot from now on."""


@pytest.fixture
def first(agent: Callable[..., Agent]) -> Agent:
    """An agent that has been here long enough to have been here first."""
    return agent()


@pytest.fixture
def second(agent: Callable[..., Agent]) -> Callable[[], Agent]:
    def start() -> Agent:
        one = agent("--ros-args", "-p", "frame_prefix:=b_")
        one.wait_for_line("other_agent_here")
        return one

    return start


class Seen:
    """What a peer sees of the two robots."""

    def __init__(self, peer: Peer, agents: int = 1) -> None:
        self.peer = peer
        self.odom = hear(peer, Odometry, "/edgevox/odom", qos_profile_sensor_data)
        self.response = peer.listen("response", publishers=agents)
        self.presence = peer.listen("presence", STATE, publishers=agents)

    def wait_moving(self, frame: str) -> None:
        self.odom.wait_for(
            lambda m: m.child_frame_id == frame and speed(m) > 0.05, 20, len(self.odom.messages)
        )

    def wait_standing(self, frame: str) -> None:
        self.odom.wait_for(
            lambda m: m.child_frame_id == frame and speed(m) < 0.01, 20, len(self.odom.messages)
        )

    def moved(self, frame: str) -> bool:
        return any(m.child_frame_id == frame and speed(m) > 0.02 for m in self.odom.messages)

    def id_of(self, agent: Agent) -> str:
        pid = agent.process.pid
        return json.loads(self.presence.wait_for(lambda m: json.loads(m)["pid"] == pid))["id"]

    def wait_in_charge(self, agent: Agent, since: int = 0, timeout_s: float = 15.0) -> None:
        def this(message: str) -> bool:
            said = json.loads(message)
            return said["pid"] == agent.process.pid and said["in_charge"]

        self.presence.wait_for(this, timeout_s, since)


def speed(message: Odometry) -> float:
    return abs(message.twist.twist.linear.x) + abs(message.twist.twist.angular.z)


def kill(agent: Agent) -> None:
    agent.process.send_signal(signal.SIGKILL)
    agent.process.wait(HUNG_S)


def levels(heard: Messages) -> Callable[[bytes, str], DiagnosticStatus]:
    def wait(level: bytes, words: str) -> DiagnosticStatus:
        def found(message: DiagnosticArray) -> list[DiagnosticStatus]:
            named = (one for one in message.status if one.name.endswith(": presence"))
            return [one for one in named if one.level == level and words in one.message]

        return found(heard.wait_for(found))[0]

    return wait


def test_both_say_so_and_the_later_one_refuses_every_way_of_moving(first, second, peer):
    one = peer()
    seen, wait = Seen(one), levels(hear(one, DiagnosticArray, "/diagnostics", RELIABLE))
    wait(DiagnosticStatus.OK, "alone on /edgevox")
    later = second()
    client = Client(one)
    assert "in_charge=True" in first.wait_for_line("other_agent_here")
    assert "in_charge=False" in later.wait_for_line("other_agent_here")
    wait_until(lambda: one.node.count_publishers("/edgevox/response") == 2, "both answers")
    wait(DiagnosticStatus.WARN, f"pid {later.process.pid}")
    assert f"pid {first.process.pid}" in wait(DiagnosticStatus.ERROR, "refuses to move").message

    one.send("text_input", "go to the bedroom", subscribers=2)
    seen.response.wait_for(lambda m: m == phrases.begins("navigate_to", room="bedroom"))
    seen.response.wait_for(lambda m: m == REFUSED)
    seen.wait_moving(FIRST)
    one.send("text_input", "stop")
    seen.wait_standing(FIRST)

    steering = Stream(tell(one, Twist, "/edgevox/cmd_vel", subscribers=2), twist(SENT_M_S, 0.0))
    seen.wait_moving(FIRST)
    later.wait_for_line("velocity_refused")
    steering.end()
    seen.wait_standing(FIRST)

    goal = PoseStamped()
    goal.header.frame_id, goal.pose.position.x, goal.pose.position.y = "map", 3.0, 3.0
    tell(one, PoseStamped, "/edgevox/goal_pose", subscribers=2)(goal)
    later.wait_for_line("goal_pose_refused")
    seen.wait_moving(FIRST)
    one.send("interrupt", "now")
    seen.wait_standing(FIRST)

    client.send("navigate_to", room="kitchen")
    later.wait_for_line("action_goal_rejected")
    assert not seen.moved(SECOND)
    assert any(m.child_frame_id == SECOND for m in seen.odom.messages)


def test_a_stop_word_and_interrupt_reach_both(first, second, peer):
    second()
    one = peer()
    event = one.listen("agent_event", publishers=2)
    response = one.listen("response", publishers=2)
    one.send("text_input", "stop", subscribers=2)
    stops = lambda: [m for m in event.messages if "safety_preempt" in m]  # noqa: E731
    wait_until(lambda: len(stops()) == 2, "both stop")
    wait_until(lambda: response.messages == [phrases.said("standing")] * 2, "both say so")


def test_who_is_told_to_take_over_moves_and_the_other_one_stands(first, second, peer):
    later = second()
    one = peer()
    seen = Seen(one, agents=2)
    one.send("text_input", "go to the bedroom", subscribers=2)
    seen.wait_moving(FIRST)

    one.send("take_over", seen.id_of(later), subscribers=2)
    first.wait_for_line(YIELDS)
    later.wait_for_line(TAKES)
    seen.wait_standing(FIRST)
    seen.response.wait_for(lambda m: "Another agent is in charge" in m and m != REFUSED)
    since = len(seen.odom.messages)
    one.send("text_input", "go to the bedroom")
    seen.wait_moving(SECOND)
    assert not any(
        m.child_frame_id == FIRST and speed(m) > 0.05 for m in seen.odom.messages[since:]
    )

    one.send("take_over", seen.id_of(first))
    seen.wait_standing(SECOND)
    one.send("text_input", "go to the bedroom")
    seen.wait_moving(FIRST)


def test_an_id_that_nobody_has_changes_nothing_and_is_said(first, peer):
    one = peer()
    one.send("take_over", "nobody")
    assert "topic=take_over" in first.wait_for_line("message_refused")
    tell(one, String, "/edgevox/presence", STATE)(String(data="{}"))
    first.wait_for_line("topic=presence")
    response = one.listen("response")
    one.send("text_input", "go to the bedroom")
    response.wait_for(lambda m: m == phrases.begins("navigate_to", room="bedroom"))


@pytest.mark.parametrize("end", [Agent.terminate, kill])
def test_when_the_first_one_is_gone_the_refusal_ends_by_itself(first, second, peer, end):
    later = second()
    seen = Seen(peer(), agents=2)
    since = len(seen.presence.messages)
    end(first)
    seen.wait_in_charge(later, since)  # sooner than the 20 s for which the graph shows it
    later.wait_for_line("other_agent_gone")
    later.wait_for_line(TAKES)
    seen.peer.send("text_input", "go to the bedroom")
    seen.wait_moving(SECOND)


@pytest.mark.parametrize("end", [Agent.terminate, kill])
def test_one_that_is_started_again_never_waits_for_its_predecessor(agent, peer, first, end):
    end(first)
    again = agent()
    seen = Seen(peer())
    seen.peer.send("text_input", "go to the bedroom")
    seen.response.wait_for(lambda m: m == phrases.begins("navigate_to", room="bedroom"))
    seen.wait_moving(FIRST)
    assert "other_agent_here" not in again.output


def test_one_that_was_frozen_is_first_again_when_it_goes_on(first, second, peer):
    later = second()
    seen = Seen(peer(), agents=2)
    first.process.send_signal(signal.SIGSTOP)
    try:
        later.wait_for_line(TAKES)
        since = len(later.lines)
    finally:
        first.process.send_signal(signal.SIGCONT)
    wait_until(lambda: any(YIELDS in line for line in later.lines[since:]), "it yields again")
    seen.peer.send("text_input", "go to the bedroom", subscribers=2)
    seen.response.wait_for(lambda m: m == REFUSED)
    seen.wait_moving(FIRST)


def until_both_are_heard(one, response):
    """Ask again and again: what an agent says before it knows who listens is lost."""
    for _ in range(int(HUNG_S / AGAIN_S)):
        before = len(response.messages)
        one.send("text_input", "where are you", subscribers=2)
        with suppress(AssertionError):
            response.wait_until(lambda: len(response.messages) >= before + 2, AGAIN_S)  # noqa: B023
            return
    pytest.fail("only one of them was heard")


def test_of_two_that_drive_one_robot_over_ros_2_only_the_first_does(agent, peer, domain):
    with wheels(domain=domain, namespace="/robot1"):
        agent("--namespace=/robot1", robot="robot-external")
        one = peer()
        state = one.listen("robot_state", STATE)
        state.wait_for(lambda m: json.loads(m)["pose"] is not None)
        asked = Velocities(one, "/robot1/cmd_vel")
        one.send("text_input", "go to x 5 y 0")
        wait_until(lambda: asked.moving, "it is driven")

        later = agent("--namespace=/robot1", robot="robot-external")
        later.wait_for_line("other_agent_here")
        response = one.listen("response", publishers=2)
        until_both_are_heard(one, response)
        one.send("text_input", "go to x minus 5 y 0", subscribers=2)
        response.wait_for(lambda m: m == REFUSED)
        before = len(asked.moving)
        wait_until(lambda: len(asked.moving) > before, "it is driven on")
        assert "driving" not in later.output
        one.send("text_input", "stop")
        response.wait_for(lambda m: m == phrases.said("stopped"))
