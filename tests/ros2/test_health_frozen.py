"""A node whose executor or world is frozen says so over HTTP in ten seconds, and gets over it."""

import http.client
import json
import os
import socket
import subprocess
import sys
import threading
from contextlib import ExitStack
from pathlib import Path

import pytest
from agent_process import WITHOUT_ROS2
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from guards import HUNG_S, run_program
from interop_rig import hear
from ports import free_port
from waiting import wait_until

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.core.commands import TextInput
from edgevox.core.events import Answered
from edgevox.core.settings import load_settings
from edgevox.core.status import STALL_S
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.world.load import load_world
from edgevox.ros2.node import BEAT_S

pytestmark = pytest.mark.long

HEALTH = str(Path(sys.executable).with_name("edgevox-health"))


def live(port, path="/live"):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=HUNG_S)
    connection.request("GET", path)
    answer = connection.getresponse()
    told = answer.status, json.loads(answer.read())["checks"]
    connection.close()
    return told


def answers(port, status):
    """Ask until that is the answer; what was said."""
    return wait_until(lambda: (told := live(port))[0] == status and told, f"{status}")[1]


def test_what_is_frozen_is_found_within_ten_seconds():
    assert STALL_S + BEAT_S < 10.0


class Sticky(PymunkEngine):
    """A world whose next step can be made to take as long as somebody likes."""

    def __init__(self, world):
        super().__init__(world)
        self.free = threading.Event()
        self.free.set()
        self.stuck = threading.Event()

    def step(self, command):
        if not self.free.is_set():
            self.stuck.set()
            self.free.wait(HUNG_S)
        return super().step(command)


@pytest.fixture
def node(domain, monkeypatch):
    """A whole agent in this process; its port, its parts and its world."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    port = free_port()
    flags = {"text_mode": True, "ros2": True, "llm": "none", "health_port": port}
    world = load_world()
    engine = Sticky(world)
    with ExitStack() as stack:
        body = DiffDriveRobot("robot-apartment", world, engine)
        parts = build_parts(stack, load_settings(flags), body)
        start_parts(stack, parts)
        stack.callback(engine.free.set)
        yield port, parts, engine


def test_a_callback_that_blocks_the_executor_is_found_and_forgotten(node, peer):
    port, parts, _ = node
    assert live(port)[0] == 200
    entered, released = threading.Event(), threading.Event()

    def block(_):
        entered.set()
        released.wait(HUNG_S)

    forget = parts.bus.subscribe(Answered, block)
    try:
        asking = peer()
        asking.listen("info")  # from then on the node knows of this peer, and takes what it sends
        asking.send("command", "list_languages")
        assert entered.wait(HUNG_S)
        checks = answers(port, 503)
        assert checks["ros2"].startswith("has not moved for")
        assert checks["body"] == checks["conversation"] == "ok"
    finally:
        released.set()
        forget()
    answers(port, 200)


def test_a_step_of_the_world_that_blocks_is_found_and_forgotten(node, peer):
    port, parts, engine = node
    said = hear(peer(), DiagnosticArray, "/diagnostics")
    said.wait_until(lambda: said.messages)
    engine.free.clear()
    parts.conversation.submit(TextInput("go to the kitchen"))
    assert engine.stuck.wait(HUNG_S)
    checks = answers(port, 503)
    assert checks["body"].startswith("has not moved for")
    said.wait_until(lambda: sim(said.messages[-1]) == DiagnosticStatus.ERROR)
    engine.free.set()
    answers(port, 200)
    said.wait_until(lambda: sim(said.messages[-1]) != DiagnosticStatus.ERROR)


def sim(array):
    return next(one.level for one in array.status if one.name == "/edgevox/edgevox: sim")


def test_a_process_says_how_it_is_to_whoever_asks(agent):
    port = free_port()
    agent("--health-port", str(port))
    environment = {**os.environ, "EDGEVOX_HEALTH_PORT": str(port)}

    def ask(*flags):
        return run_program([HEALTH, *flags], env=environment)

    assert ask("--ready").stdout.startswith("ok: conversation ok, body ok, ros2 ok")
    assert ask("--live").returncode == 0


def test_without_ros2_it_is_alive_and_never_ready():
    port = free_port()
    flags = ["robot-apartment", "--text-mode", "--ros2", "--llm=none", f"--health-port={port}"]
    process = subprocess.Popen(
        [sys.executable, "-c", WITHOUT_ROS2, *flags],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        while "is ready" not in process.stdout.readline():
            assert process.poll() is None
        assert live(port)[0] == 200
        status, checks = live(port, "/ready")
        assert (status, checks["rclpy"]) == (503, "rclpy cannot be imported")
    finally:
        process.terminate()
        process.communicate(timeout=HUNG_S)


def test_a_port_that_is_taken_ends_the_agent_with_its_reason(agent):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        one = agent("--health-port", str(port), wait=False)
        one.wait_for_line(f"health_port: got '127.0.0.1:{port}'")
        assert one.process.wait(HUNG_S) == 2
