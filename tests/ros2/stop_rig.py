"""Every way to stop a robot, and what it may be busy with meanwhile, as tables."""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

from action_rig import Client
from agent_process import READY, Agent
from guards import HUNG_S
from halting import halt_of, stands_for_good
from peer import RELIABLE, STATE, Peer
from robot_states import moving
from std_msgs.msg import String
from waiting import wait_until

sys.path.insert(0, str(Path(__file__).parents[1]))

from llm_server import Server

from edgevox.agent.llm.protocol import SAY

FREEZE_S = 3.0
TARGETS = ({"x": 3.0, "y": 4.0}, {"x": 8.0, "y": 8.0})
SENTENCES = 80
"""More than may wait: `MAX_WAITING` of them do."""
BURN = "while True: pass"


class Thinker:
    """A model server that reads its prompt until `primed`, and tells its story to the very end."""

    def __init__(self):
        self.primes, self.primed, self.tells = (threading.Event() for _ in range(3))
        self.server = Server([self._prime, self._tell], "llamacpp", "127.0.0.1")

    def _prime(self, reply):
        self.primes.set()
        self.primed.wait()
        reply.answer(["."])

    def _tell(self, reply):
        reply.stream()
        reply.piece(SAY.strip())
        reply.piece(" Once upon a time there was a robot.")
        self.tells.set()
        reply.over.wait()


class Robot:
    """A running agent with a model that never comes to an end, and a peer that talks to it."""

    def __init__(self, domain, *options, state_hz=50):
        self.thinker = Thinker()
        self.agent = Agent(
            *("robot-apartment", "--text-mode", "--ros2", "--llm", "none"),
            *("--ros2-state-hz", str(state_hz), "--llm-endpoint", self.thinker.server.url),
            *("--llm-endpoint-timeout", "600", *options),
            domain=domain,
            stdin=subprocess.PIPE,
        )
        self.agent.wait_for_line(READY)
        self.peer = Peer(domain)
        self.client = Client(self.peer)
        self.state = self.peer.listen("robot_state", STATE)
        self.sentence = self.peer.listen("bot_sentence")
        self.words = self.peer.listen("transcription")
        self.info = self.peer.listen("info")
        # Matched now: a stop must not wait for that.
        self.interrupt = self.peer.node.create_publisher(
            String, self.peer.name("interrupt"), RELIABLE
        )
        wait_until(lambda: self.interrupt.get_subscription_count() > 0, "interrupt")
        self.peer.send("text_input", "where are you")
        self.has_looked()

    def close(self):
        self.peer.close()
        self.agent.process.stdin.close()
        self.thinker.primed.set()
        self.thinker.server.close()
        assert self.agent.terminate() == 0

    def newest(self):
        """The last state that was heard: a frozen robot says no more."""
        return json.loads(self.state.messages[-1])

    def has_looked(self):
        """Wait until it has looked at every command that was sent: they keep their order."""
        heard = len(self.info.messages)
        self.peer.send("command", "list_languages")
        self.info.wait_for(lambda _: True, since=heard)

    def type(self, line):
        self.agent.process.stdin.write(f"{line}\n")
        self.agent.process.stdin.flush()

    def goes(self):
        """Ask for a drive away from here, as a program does."""
        here = self.newest()["pose"]["x"]
        return self.client.send("navigate_xy", json.dumps(TARGETS[here < 5.0]))

    def drives(self):
        goal = self.goes()
        self.state.wait_for(moving, since=len(self.state.messages))
        return goal

    def stood(self, since):
        """Now that its goal has ended: which state is the first from which on it stands."""
        self.state.wait_for(stands_for_good, since=len(self.state.messages))
        heard = self.state.messages
        moved = [n for n in range(since, len(heard)) if not stands_for_good(heard[n])]
        return moved[-1] + 1 if moved else since

    def halted(self, since):
        """How it stopped, of a goal that it had at `since` or after it."""
        return halt_of(self.state.messages[since : self.stood(since) + 1])


@contextmanager
def driving(robot):
    yield robot.drives()


@contextmanager
def accepting(robot):
    """Its goal was accepted, and does not move the robot yet."""
    yield robot.goes()


@contextmanager
def priming(robot):
    assert robot.thinker.primes.wait(HUNG_S)
    yield robot.drives()


@contextmanager
def generating(robot):
    _let_it_think(robot)
    yield robot.drives()


@contextmanager
def crowded(robot):
    """It thinks, and as many sentences wait as may."""
    _let_it_think(robot)
    pause = threading.Event()
    for _ in range(SENTENCES):
        robot.peer.send("text_input", "where are you")
        pause.wait(0.005)  # a topic keeps the last 10
    robot.has_looked()
    yield robot.drives()


def _let_it_think(robot):
    robot.thinker.primed.set()
    robot.thinker.tells.clear()
    robot.peer.send("text_input", "why is the sky blue")
    assert robot.thinker.tells.wait(HUNG_S)


@contextmanager
def starved(robot):
    """All of its threads share one core with a program that wants it for itself."""
    tasks = [int(one) for one in os.listdir(f"/proc/{robot.agent.process.pid}/task")]
    before = os.sched_getaffinity(robot.agent.process.pid)
    core = {min(before)}
    with subprocess.Popen([sys.executable, "-c", BURN]) as burner:
        try:
            for task in (burner.pid, *tasks):
                os.sched_setaffinity(task, core)
            yield robot.drives()
        finally:
            burner.kill()
            for task in tasks:
                _let_run(task, before)


def _let_run(task, cores):
    try:
        os.sched_setaffinity(task, cores)
    except ProcessLookupError:
        """That thread has ended."""


@contextmanager
def frozen(robot):
    """Not one of its threads runs; the word comes shortly before they go on."""
    goal = robot.drives()
    robot.agent.process.send_signal(signal.SIGSTOP)
    try:
        threading.Event().wait(FREEZE_S)
        yield goal
    finally:
        robot.agent.process.send_signal(signal.SIGCONT)


SITUATIONS = {
    one.__name__: one for one in (driving, accepting, priming, generating, crowded, starved, frozen)
}
WAYS = {
    "text_input": lambda robot, _: robot.peer.send("text_input", "stop"),
    "interrupt": lambda robot, _: robot.interrupt.publish(String()),
    "command": lambda robot, _: robot.peer.send("command", "reset"),
    "standard input": lambda robot, _: robot.type("stop"),
    "action cancel": lambda robot, goal: robot.client.cancel_without_waiting(goal),
}


def settle(robot):
    """Whatever was asked for before is over."""
    robot.peer.send("command", "reset")
    robot.has_looked()
    robot.state.wait_for(stands_for_good, since=len(robot.state.messages))
