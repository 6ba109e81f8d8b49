"""Floods: nothing hangs, memory and threads come back, and the next command works."""

import subprocess
import sys
import threading
import time
from pathlib import Path

import phrases
import pytest
from action_rig import Client
from guards import HUNG_S
from peer import STATE
from robot_states import moving, standing

pytestmark = pytest.mark.long

DEAF = str(Path(__file__).with_name("deaf_peer.py"))


class Robot:
    """A running agent, a peer that talks to it, and what the agent takes from the machine."""

    def __init__(self, process, peer):
        self._process, self.peer = process, peer
        self.response = peer.listen("response")
        self.state = peer.listen("robot_state", STATE)
        self.works()
        self.before = process.taken()

    def works(self, timeout_s=HUNG_S):
        """The next command is answered, by one that drives and another that stops."""
        heard = len(self.response.messages)
        self.peer.send("text_input", "what is your battery")
        self.response.wait_for(lambda m: "percent" in m, timeout_s, since=heard)
        self.peer.send("text_input", "drive to x 3 y 4")
        self.state.wait_for(moving, timeout_s, since=len(self.state.messages))
        heard = len(self.response.messages)
        self.peer.send("text_input", "stop")
        self.response.wait_for(lambda m: m == phrases.said("stopped"), timeout_s, since=heard)
        self.state.wait_for(standing, timeout_s, since=len(self.state.messages))

    def settled(self):
        """Nothing of a flood is left: no answer for a second."""
        pause = threading.Event()
        heard = -1
        while heard != len(self.response.messages):
            heard = len(self.response.messages)
            pause.wait(1.0)

    def is_as_before(self):
        self._process.takes_no_more_than(self.before)

    def heartbeat(self):
        """The ROS 2 thread is alive: a state of the robot arrives."""
        self.state.wait_for(lambda _: True, since=len(self.state.messages))


def over_a_second(count, send):
    """Call `send` this many times, spread over one second."""
    begun, pause = time.monotonic(), threading.Event()
    for number in range(count):
        send()
        pause.wait(max(0.0, begun + (number + 1) / count - time.monotonic()))


@pytest.fixture
def process(agent):
    return agent()


@pytest.fixture
def robot(process, peer):
    return Robot(process, peer())


@pytest.mark.parametrize("spread", [True, False], ids=["over a second", "at once"])
def test_a_thousand_sentences(robot, spread):
    def send():
        robot.peer.send("text_input", "where are you")

    if spread:
        over_a_second(1000, send)
    else:
        for _ in range(1000):
            send()
    robot.heartbeat()
    robot.settled()
    robot.works()
    robot.is_as_before()


def test_stop_works_in_the_middle_of_a_thousand_sentences(robot):
    robot.peer.send("text_input", "drive to x 3 y 4")
    robot.state.wait_for(moving)
    heard = len(robot.response.messages)
    flood = threading.Thread(
        target=over_a_second,
        args=(1000, lambda: robot.peer.send("text_input", "where are you")),
    )
    flood.start()
    robot.response.wait_for(lambda m: m.startswith("I am in"), since=heard)
    robot.peer.send("interrupt", "")
    robot.state.wait_for(standing, since=len(robot.state.messages))
    flood.join()
    robot.settled()
    robot.works()


def test_a_hundred_interrupts(robot):
    robot.peer.send("text_input", "drive to x 3 y 4")
    robot.state.wait_for(moving)
    for _ in range(100):
        robot.peer.send("interrupt", "now")
    robot.state.wait_for(standing, since=len(robot.state.messages))
    robot.works()
    robot.is_as_before()


def test_fifty_goals(robot):
    client = Client(robot.peer)
    goals = client.send_all([("navigate_to", '{"room": "kitchen"}')] * 50)
    assert all(goal.accepted for goal in goals)
    *replaced, last = client.ask_ends_of(goals)
    assert {client.answer(one)[0] for one in replaced} == {"canceled"}
    robot.peer.send("text_input", "stop")
    assert client.answer(last)[0] == "canceled"
    robot.works()
    robot.is_as_before()


def test_a_subscriber_that_never_reads_and_is_killed_in_the_middle(robot, domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with subprocess.Popen([sys.executable, DEAF], stdout=subprocess.PIPE, text=True) as deaf:
        try:
            assert deaf.stdout.readline() == "talking\n"
            heard = len(robot.response.messages)
            robot.response.wait_for(lambda _: True, since=heard + 200)
            robot.heartbeat()
        finally:
            deaf.kill()
    robot.heartbeat()
    robot.settled()
    robot.works()
    robot.is_as_before()
