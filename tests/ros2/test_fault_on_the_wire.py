"""Faults as another machine sees them: what is said, what /diagnostics says, and how it ends."""

import json
import math
import os
import signal
import threading
from contextlib import ExitStack

import phrases
import pytest
from agent_process import READY, Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from guards import HUNG_S
from interop_rig import hear
from peer import RELIABLE, STATE, Peer

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.core.settings import load_settings
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.sim_loop import BROKE
from edgevox.robots.world.load import load_world
from tf2_msgs.msg import TFMessage

pytestmark = pytest.mark.long

"""What an engine gives a container before it kills it."""


class Fragile(PymunkEngine):
    """A world whose robot can be made to have no speed that is a number."""

    def __init__(self, world):
        super().__init__(world)
        self.break_it = threading.Event()

    def step(self, command):
        if self.break_it.is_set():
            self.break_it.clear()
            self._robot.velocity = (math.nan, math.nan)
        return super().step(command)


@pytest.fixture
def node(domain, monkeypatch):
    """A whole agent in this process, and its world."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    world = load_world()
    engine = Fragile(world)
    with ExitStack() as stack:
        body = DiffDriveRobot("robot-apartment", world, engine)
        settings = load_settings({"text_mode": True, "ros2": True, "llm": "none"})
        start_parts(stack, build_parts(stack, settings, body))
        yield engine


def listen_to_diagnostics(peer):
    heard = hear(peer, DiagnosticArray, "/diagnostics", RELIABLE)

    def wait_for(component, level, since=0):
        """A message in which the component has this level; what it says."""

        def status(message):
            names = {one.name.rpartition(": ")[2]: one for one in message.status}
            return names[component]

        found = heard.wait_for(lambda m: status(m).level == level, 30.0, since)
        return status(found).message

    return heard, wait_for


def test_a_world_that_diverges_fails_the_goal_aloud_and_spoils_nobodys_tree(node, peer):
    one = peer()
    response, event = one.listen("response"), one.listen("agent_event")
    state, frames = one.listen("robot_state", STATE), hear(one, TFMessage, "/tf", RELIABLE)
    diagnostics, wait_for = listen_to_diagnostics(one)
    one.send("text_input", "go to the bedroom")
    state.wait_for(lambda m: json.loads(m)["velocity"]["linear"] > 0.1)

    node.break_it.set()

    response.wait_for(lambda m: m == f"I could not do that: {BROKE}")
    end = json.loads(event.wait_for(lambda m: json.loads(m).get("status") == "failed"))
    assert (end["error"], end["code"]) == (str(BROKE), "broke")
    broken = len(diagnostics.messages)
    assert "its numbers broke and it was put back" in wait_for("sim", DiagnosticStatus.ERROR)
    one.send("text_input", "go to the kitchen")
    response.wait_for(lambda m: m == phrases.done("navigate_to", room="kitchen"))
    assert wait_for("sim", DiagnosticStatus.OK, broken) == "runs"
    for message in state.messages:
        json.loads(message, parse_constant=pytest.fail)
        assert "null" not in message.partition('"goal"')[0]
    for message in frames.messages:
        for link in message.transforms:
            move, turn = link.transform.translation, link.transform.rotation
            assert all(map(math.isfinite, (move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w)))


def test_without_its_model_it_is_on_ros_2_and_says_what_it_lacks(
    agent, peer, monkeypatch, tmp_path
):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    agent("--llm", "qwen2.5-coder-0.5b-instruct")
    one = peer()
    response = one.listen("response")
    _, wait_for = listen_to_diagnostics(one)

    said = wait_for("llm", DiagnosticStatus.ERROR)

    assert "get it with: edgevox-models fetch qwen2.5-coder-0.5b-instruct" in said
    one.send("text_input", "where are you")
    response.wait_for(lambda m: m.startswith("I am in"))
    one.send("text_input", "why does ice float on water?")
    response.wait_for(lambda m: m == phrases.said("model_failed"))


class Flood:
    """Words and velocities, as fast as they go, until it is over."""

    def __init__(self, domain):
        self._peer = Peer(domain)
        self._over = threading.Event()
        self._peer.send("text_input", "where are you")
        self._thread = threading.Thread(target=self._pour)
        self._thread.start()

    def _pour(self):
        while not self._over.wait(0.0002):
            self._peer.send("text_input", "tell me where you are " * 20)
            self._peer.send("tts_request", "blah " * 50)

    def close(self):
        self._over.set()
        self._thread.join()
        self._peer.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_while_it_drives_in_a_flood(domain, peer, number):
    flags = ("--text-mode", "--ros2", "--llm", "none")
    one = Agent("robot-apartment", *flags, domain=domain)
    try:
        one.wait_for_line(READY)
        other = peer()
        state = other.listen("robot_state", STATE)
        other.send("text_input", "go to the bedroom")
        state.wait_for(lambda m: json.loads(m)["velocity"]["linear"] > 0.1)
        flood = Flood(domain)
        state.wait_for(lambda _: True, 20, since=len(state.messages))
        try:
            one.process.send_signal(number)
            assert one.process.wait(HUNG_S) == 0
        finally:
            flood.close()
    finally:
        one.terminate()
    assert "Traceback" not in one.output


def test_a_signal_ends_it_before_it_has_a_handler_as_a_shell_would_say(domain):
    one = Agent("robot-panda", "--text-mode", "--ros2", "--llm", "none", domain=domain)
    maps = f"/proc/{one.process.pid}/maps"
    while "libmujoco" not in open(maps, encoding="utf-8").read():  # noqa: SIM115 - it builds its world
        assert one.process.poll() is None
        os.sched_yield()

    one.process.send_signal(signal.SIGTERM)

    assert one.process.wait(HUNG_S) in (0, -signal.SIGTERM)
    one.terminate()
    assert "Traceback" not in one.output
