"""A peer that floods one input and is killed: stop works meanwhile, and nothing of it is left."""

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from agent_process import READY, Agent
from halting import BRAKED_S, LEFT_M, halt_of, stands_for_good
from peer import RELIABLE, STATE, Peer
from robot_states import moving
from std_msgs.msg import String
from waiting import wait_until

pytestmark = pytest.mark.long

FLOODER = str(Path(__file__).with_name("chaos_flooder.py"))
FLOOD_S = 1.5
MOST_LINES = 150
MEGABYTES = 2
DEPTH = 10
FLOODS = 4


class Robot:
    """A running agent without a model or a voice, and a peer that listens."""

    def __init__(self, process: Agent, peer: Peer) -> None:
        self.process, self.peer = process, peer
        self.response, self.state = peer.listen("response"), peer.listen("robot_state", STATE)
        self.interrupt = peer.node.create_publisher(String, peer.name("interrupt"), RELIABLE)
        wait_until(lambda: self.interrupt.get_subscription_count() > 0, "interrupt")
        self.works()
        self.before = process.taken()

    def newest(self):
        return json.loads(self.state.wait_for(lambda _: True, since=len(self.state.messages)))

    def stops(self):
        """By an interrupt, in the middle of a drive."""
        since = len(self.state.messages) - 1
        self.interrupt.publish(String())
        self.state.wait_for(stands_for_good, since=since)
        halt = halt_of(self.state.messages[since:])
        assert halt.braked_s < BRAKED_S
        assert halt.left_m > LEFT_M

    def works(self):
        """It answers in English, drives and stops, once what waits is done or forgotten."""
        wait_until(self._answers, "an answer")
        target = "x 3 y 4" if self.newest()["pose"]["x"] > 5 else "x 8 y 8"
        self.peer.send("text_input", f"drive to {target}")
        self.state.wait_for(moving, since=len(self.state.messages))
        self.stops()

    def is_as_before(self):
        self.process.takes_no_more_than(self.before)

    def _answers(self):
        heard = len(self.response.messages)
        for topic, text in (("set_language", "en"), ("interrupt", ""), ("command", "unmute")):
            self.peer.send(topic, text)
        threading.Event().wait(0.5)  # between topics there is no order: it might stop the question
        self.peer.send("text_input", "what is your battery")
        try:
            self.response.wait_for(lambda m: "percent" in m, 2.0, since=heard)
        except AssertionError:
            return False
        return True


@pytest.fixture(scope="module")
def robot(domain):
    process = Agent("robot-apartment", "--text-mode", "--ros2", "--llm", "none", domain=domain)
    process.wait_for_line(READY)
    peer = Peer(domain)
    yield Robot(process, peer)
    peer.close()
    assert process.terminate() == 0


@pytest.mark.parametrize("what", ["language", "parameters", "goals", "velocity"])
def test_a_peer_that_floods_and_is_killed(robot, domain, what):
    pause, lines = threading.Event(), len(robot.process.lines)
    if what not in ("goals", "velocity"):  # which move it by themselves
        robot.peer.send("text_input", "go to the bedroom")
        robot.state.wait_for(moving, since=len(robot.state.messages))
    flooder = subprocess.Popen(
        [sys.executable, FLOODER, what], env={**os.environ, "ROS_DOMAIN_ID": str(domain)}
    )
    try:
        subscriptions = robot.peer.node.get_node_names
        wait_until(lambda: "flooder" in subscriptions(), "the flooder")
        pause.wait(FLOOD_S)
        if what not in ("goals", "velocity"):
            robot.stops()
        robot.newest()
        assert flooder.poll() is None
    finally:
        flooder.kill()
        flooder.wait()
    robot.works()
    robot.is_as_before()
    said = [line for line in robot.process.lines[lines:] if line[:2] not in ("> ", "  ")]
    assert len(said) < MOST_LINES, said[:20]


def test_strings_of_megabytes_take_only_the_middlewares_own_buffers(robot):
    """Each topic keeps as many as it is deep and one more, as large as the largest that came.

    How many of them one flood fills depends on who is faster, so that all of them are allowed for.
    """
    topics = ("text_input", "tts_request", "command", "set_language")
    buffers_mb = len(topics) * (DEPTH + 1) * MEGABYTES
    before = robot.process.taken()
    for number in range(FLOODS):
        for topic in topics:
            for _ in range(DEPTH + 2):
                robot.peer.send(topic, f"{number}" + " ever" * (MEGABYTES * 200_000))
        robot.works()
    robot.process.takes_no_more_than(before, buffers_mb)
