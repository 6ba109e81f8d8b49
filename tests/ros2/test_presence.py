"""Two agents on one namespace: both say so, and only one of them moves the robot."""

import json
import signal
from collections.abc import Callable, Iterator
from contextlib import closing, suppress

import phrases
import pytest
from action_rig import Client
from agent_process import READY, Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from external_rig import Velocities, wheels
from geometry_msgs.msg import PoseStamped, Twist
from guards import HUNG_S
from halting import settle
from interop_rig import Messages, Stream, hear, tell, twist
from nav_msgs.msg import Odometry
from peer import RELIABLE, STATE, Peer
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
from stop_rig import TARGETS
from waiting import wait_until

FIRST, SECOND = "base_link", "b_base_link"
"""How the two robots are told apart on the topics that they share."""
AGAIN_S = 5.0
REFUSED = phrases.refused("other_agent")
SENT_M_S = 0.2
SOONER_S = 15.0
"""Than the 20 s for which the graph shows one that was killed."""


class Pair:
    """Two agents on one namespace, the first of which has been here for longer, and a peer."""

    def __init__(self, domain: int) -> None:
        self._domain = domain
        self.peer = Peer(domain)
        self.first = self.start()
        self.second = self.start("--ros-args", "-p", "frame_prefix:=b_")
        self.second.wait_for_line("other_agent_here")
        wait_until(lambda: self.peer.node.count_publishers("/edgevox/response") == 2, "both")
        self.seen = Seen(self.peer, agents=2)

    def start(self, *arguments: str) -> Agent:
        flags = ("--text-mode", "--ros2", "--llm", "none", *arguments)
        one = Agent("robot-apartment", *flags, domain=self._domain)
        one.wait_for_line(READY)
        return one

    def is_whole(self) -> bool:
        return self.first.process.poll() is None and self.second.process.poll() is None

    def begin(self) -> None:
        """The first is in charge, and whatever was asked for before is over."""
        since = len(self.seen.presence.messages)
        self.peer.send("take_over", self.seen.id_of(self.first), subscribers=2)
        self.seen.wait_in_charge(self.first, since)
        settle(self.peer, agents=2)
        for frame in (FIRST, SECOND):
            self.seen.wait_standing(frame)

    def close(self) -> None:
        for one in (self.first, self.second):
            one.leave()
        for one in (self.first, self.second):
            one.terminate()
        self.peer.close()


@pytest.fixture(scope="module")
def _pairs(_domains: Iterator[int]) -> Iterator[list[Pair]]:
    made: list[Pair] = []
    yield made
    for one in made:
        one.close()


@pytest.fixture
def pair(_pairs: list[Pair], _domains: Iterator[int]) -> Pair:
    """Two agents; others where a test has ended one of the last."""
    if not (_pairs and _pairs[-1].is_whole()):
        _pairs.append(Pair(next(_domains)))
    _pairs[-1].begin()
    return _pairs[-1]


class Seen:
    """What a peer sees of the two robots."""

    def __init__(self, peer: Peer, agents: int = 1) -> None:
        self.peer = peer
        self.odom = hear(peer, Odometry, "/edgevox/odom", qos_profile_sensor_data)
        self.response = peer.listen("response", publishers=agents)
        self.presence = peer.listen("presence", STATE, publishers=agents)

    def newest(self, frame: str) -> Odometry:
        """The first odometry of this robot that comes from now on."""
        since = len(self.odom.messages)
        return self.odom.wait_for(lambda m: m.child_frame_id == frame, since=since)

    def far(self, frame: str) -> str:
        """A room that this robot needs a while to drive to."""
        return ("kitchen", "bedroom")[self.newest(frame).pose.pose.position.x > 5.0]

    def wait_moving(self, frame: str) -> None:
        self.odom.wait_for(
            lambda m: m.child_frame_id == frame and speed(m) > 0.05, since=len(self.odom.messages)
        )

    def wait_standing(self, frame: str) -> None:
        self.odom.wait_for(
            lambda m: m.child_frame_id == frame and speed(m) < 0.01, since=len(self.odom.messages)
        )

    def moved(self, frame: str, since: int) -> bool:
        return any(
            m.child_frame_id == frame and speed(m) > 0.02 for m in self.odom.messages[since:]
        )

    def id_of(self, agent: Agent) -> str:
        pid = agent.process.pid
        return json.loads(self.presence.wait_for(lambda m: json.loads(m).get("pid") == pid))["id"]

    def wait_in_charge(
        self, agent: Agent, since: int, timeout_s: float = HUNG_S, *, it_is: bool = True
    ) -> None:
        """Until this agent says whether it is: its log leaves out what changes too often."""

        def this(message: str) -> bool:
            said = json.loads(message)
            return said.get("pid") == agent.process.pid and said["in_charge"] is it_is

        self.presence.wait_for(this, timeout_s, since)

    def asks_to_drive(self, frame: str) -> int:
        """Ask this robot for a long drive, and wait for its word; how much was heard before."""
        room, since = self.far(frame), len(self.response.messages)
        self.peer.send("text_input", f"go to the {room}")
        begins = phrases.begins("navigate_to", room=room)
        self.response.wait_for(lambda m: m == begins, since=since)
        return since


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


def test_both_say_so_and_the_later_one_refuses_every_way_of_moving(pair):
    one, seen, first, later = pair.peer, pair.seen, pair.first, pair.second
    odom, lines = len(seen.odom.messages), len(later.lines)
    wait = levels(hear(one, DiagnosticArray, "/diagnostics", RELIABLE))
    client = Client(one)
    assert "in_charge=True" in first.wait_for_line("other_agent_here")
    assert "in_charge=False" in later.wait_for_line("other_agent_here")
    wait(DiagnosticStatus.WARN, f"pid {later.process.pid}")
    assert f"pid {first.process.pid}" in wait(DiagnosticStatus.ERROR, "refuses to move").message

    asked = seen.asks_to_drive(FIRST)
    seen.response.wait_for(lambda m: m == REFUSED, since=asked)
    seen.wait_moving(FIRST)
    one.send("text_input", "stop")
    seen.wait_standing(FIRST)

    steering = Stream(tell(one, Twist, "/edgevox/cmd_vel", subscribers=2), twist(SENT_M_S, 0.5))
    seen.wait_moving(FIRST)
    later.wait_for_line("velocity_refused", since=lines)
    steering.end()
    seen.wait_standing(FIRST)

    goal, target = PoseStamped(), TARGETS[seen.newest(FIRST).pose.pose.position.x < 5.0]
    goal.header.frame_id, goal.pose.position.x, goal.pose.position.y = "map", *target.values()
    tell(one, PoseStamped, "/edgevox/goal_pose", subscribers=2)(goal)
    later.wait_for_line("goal_pose_refused", since=lines)
    seen.wait_moving(FIRST)
    one.send("interrupt", "now")
    seen.wait_standing(FIRST)

    client.send("navigate_to", room="kitchen")
    later.wait_for_line("action_goal_rejected", since=lines)
    client.destroy()
    assert not seen.moved(SECOND, odom)
    assert any(m.child_frame_id == SECOND for m in seen.odom.messages[odom:])


def test_a_stop_word_and_interrupt_reach_both(pair):
    event = pair.peer.listen("agent_event", publishers=2)
    answers = len(pair.seen.response.messages)
    pair.peer.send("text_input", "stop", subscribers=2)
    stops = lambda: [m for m in event.messages if "safety_preempt" in m]  # noqa: E731
    wait_until(lambda: len(stops()) == 2, "both stop")
    both = [phrases.said("standing")] * 2
    wait_until(lambda: pair.seen.response.messages[answers:] == both, "both say so")


def test_who_is_told_to_take_over_moves_and_the_other_one_stands(pair):
    one, seen, first, later = pair.peer, pair.seen, pair.first, pair.second
    seen.asks_to_drive(FIRST)
    seen.wait_moving(FIRST)

    since, answers = len(seen.presence.messages), len(seen.response.messages)
    one.send("take_over", seen.id_of(later))
    seen.wait_in_charge(first, since, it_is=False)
    seen.wait_in_charge(later, since)
    seen.wait_standing(FIRST)
    seen.response.wait_for(
        lambda m: "Another agent is in charge" in m and m != REFUSED, since=answers
    )
    since = len(seen.odom.messages)
    seen.asks_to_drive(SECOND)
    seen.wait_moving(SECOND)
    assert not any(
        m.child_frame_id == FIRST and speed(m) > 0.05 for m in seen.odom.messages[since:]
    )

    one.send("take_over", seen.id_of(first))
    seen.wait_standing(SECOND)
    seen.asks_to_drive(FIRST)
    seen.wait_moving(FIRST)


def test_an_id_that_nobody_has_changes_nothing_and_is_said(pair):
    since = len(pair.first.lines)
    pair.peer.send("take_over", "nobody")
    assert "topic=take_over" in pair.first.wait_for_line("message_refused", since=since)
    tell(pair.peer, String, "/edgevox/presence", STATE)(String(data="{}"))
    pair.first.wait_for_line("topic=presence", since=since)
    pair.seen.asks_to_drive(FIRST)


def test_one_that_was_frozen_is_first_again_when_it_goes_on(pair):
    later, seen = pair.second, pair.seen
    since = len(seen.presence.messages)
    pair.first.process.send_signal(signal.SIGSTOP)
    try:
        seen.wait_in_charge(later, since)
        since = len(seen.presence.messages)
    finally:
        pair.first.process.send_signal(signal.SIGCONT)
    seen.wait_in_charge(later, since, it_is=False)
    asked = seen.asks_to_drive(FIRST)
    seen.response.wait_for(lambda m: m == REFUSED, since=asked)
    seen.wait_moving(FIRST)


@pytest.mark.parametrize("end", [kill, pytest.param(Agent.terminate, marks=pytest.mark.long)])
def test_when_the_first_one_is_gone_the_refusal_ends_and_none_waits_for_its_predecessors(pair, end):
    seen, later = pair.seen, pair.second
    since, lines = len(seen.presence.messages), len(later.lines)
    end(pair.first)
    seen.wait_in_charge(later, since, SOONER_S)
    later.wait_for_line("other_agent_gone", since=lines)
    later.wait_for_line("charge_changed")
    seen.asks_to_drive(SECOND)
    seen.wait_moving(SECOND)

    end(later)
    pair.first = again = pair.start()
    with closing(Peer(again.domain)) as fresh:  # those that were killed haunt the others
        seen = Seen(fresh)
        seen.asks_to_drive(FIRST)
        seen.wait_moving(FIRST)
        wait = levels(hear(fresh, DiagnosticArray, "/diagnostics", RELIABLE))
        wait(DiagnosticStatus.OK, "alone on /edgevox")
    assert "other_agent_here" not in again.output


def until_both_are_heard(one, response):
    """Ask again and again: what an agent says before it knows who listens is lost."""
    for _ in range(int(HUNG_S / AGAIN_S)):
        before = len(response.messages)
        one.send("text_input", "where are you", subscribers=2)
        with suppress(AssertionError):
            response.wait_until(lambda: len(response.messages) >= before + 2, AGAIN_S)  # noqa: B023
            return
    pytest.fail("only one of them was heard")


@pytest.mark.long
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
