"""An agent that is asked to end while it drives, seen from outside: it stands, and then it goes."""

import http.client
import json
import signal
import socket
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import phrases
import pytest
from action_rig import Client
from agent_process import READY, Agent
from geometry_msgs.msg import Twist
from guards import HUNG_S, run_program
from interop_rig import tell, twist
from peer import STATE
from robot_states import moving, standing

from edgevox.agent.text.reasons import because

HEALTH = str(Path(sys.executable).with_name("edgevox-health"))
DRAINING = because("draining")
LONG = "300"
"""A bound that no drive through the apartment needs."""


class Driving:
    """A robot on its way to the bedroom, and who watches it."""

    def __init__(self, domain, one, bound_s):
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.agent = Agent(
            "robot-apartment",
            *("--text-mode", "--ros2", "--llm", "none", "--drain-s", bound_s),
            *("--health-port", str(self.port)),
            domain=domain,
        )
        self.agent.wait_for_line(READY)
        self.peer = one
        self.events, self.response = one.listen("agent_event"), one.listen("response")
        self.state = one.listen("robot_state", STATE)
        self.client = Client(one)
        self.goal = self.client.send("navigate_to", room="bedroom")
        self.state.wait_for(moving)

    def sends(self, number=signal.SIGTERM):
        self.agent.process.send_signal(number)

    def event(self, **wanted):
        """The first event that holds all this."""
        return json.loads(self.events.wait_for(lambda m: wanted.items() <= json.loads(m).items()))

    def asks(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=HUNG_S)
        connection.request("GET", path)
        answer = connection.getresponse()
        told = json.loads(answer.read())
        connection.close()
        return answer.status, told

    def health(self, *flags):
        return run_program([HEALTH, *flags, "--port", str(self.port)])

    def ended(self):
        return self.agent.process.wait(HUNG_S)


@pytest.fixture
def driving(domain, peer):
    started = []

    def start(bound_s=LONG):
        started.append(Driving(domain, peer(), bound_s))
        return started[-1]

    yield start
    for one in started:
        one.sends()
        one.sends()  # whoever failed here is not waited for
        one.client.destroy()
        one.agent.terminate()


def test_the_goal_arrives_then_it_ends_and_meanwhile_nothing_new_begins(driving):
    robot = driving()
    robot.sends()
    robot.event(kind="drain", status="draining", by="SIGTERM")

    assert not robot.client.send("navigate_to", room="kitchen").accepted
    assert robot.event(status="rejected")["code"] == DRAINING.code
    robot.peer.send("text_input", "go to the kitchen")
    robot.response.wait_for(lambda m: m == phrases.refused("draining"))
    tell(robot.peer, Twist, "/edgevox/cmd_vel")(twist(0.4, 0.0))
    status, told = robot.asks("/ready")
    assert (status, told["checks"]["drain"]) == (503, "draining")
    assert robot.asks("/live")[0] == 200
    assert moving(robot.state.messages[-1]), "what was asked before goes on"

    assert robot.client.end_of(robot.goal)[0] == "succeeded"
    robot.event(kind="drain", status="drained")
    assert robot.ended() == 0


@pytest.mark.parametrize("bound_s", [pytest.param("0", marks=pytest.mark.long), "0.5"])
def test_a_goal_that_takes_longer_is_cancelled_and_the_robot_stands_before_the_end(
    driving, bound_s
):
    robot = driving(bound_s)
    robot.sends()
    assert robot.client.end_of(robot.goal)[0] == "canceled"
    robot.event(kind="drain", status="drained")
    assert robot.ended() == 0


@pytest.mark.long
@pytest.mark.parametrize("way", ["stop word", "interrupt"])
def test_a_stop_meanwhile_counts_at_once(driving, way):
    robot = driving()
    robot.sends()
    robot.event(kind="drain", status="draining")
    if way == "interrupt":
        robot.peer.send("interrupt", "now")
    else:
        robot.peer.send("text_input", "stop")
    assert robot.client.end_of(robot.goal)[0] == "canceled"
    robot.event(kind="drain", status="drained")
    assert robot.ended() == 0


@pytest.mark.parametrize(
    "second",
    [
        signal.SIGTERM,
        pytest.param(signal.SIGINT, marks=pytest.mark.long),
        pytest.param(signal.SIGHUP, marks=pytest.mark.long),
    ],
)
def test_a_second_signal_ends_it_at_once(driving, second):
    robot = driving()
    robot.sends()
    robot.event(kind="drain", status="draining")
    robot.sends(second)
    assert robot.ended() == 0
    assert not [one for one in robot.events.messages if '"succeeded"' in one]


def test_asked_by_the_command_a_stop_counts_at_once_and_it_stands_and_lives_until_a_signal(driving):
    robot = driving()
    with ThreadPoolExecutor(1) as beside:
        asked = beside.submit(robot.health, "--drain")
        assert robot.event(kind="drain", status="draining")["by"] == "edgevox-health"
        robot.peer.send("text_input", "stop")
        assert robot.client.end_of(robot.goal)[0] == "canceled"
        done = asked.result(HUNG_S)
    assert (done.returncode, done.stdout.strip()) == (0, "drained")
    robot.state.wait_for(standing, since=len(robot.state.messages))
    assert robot.health("--ready").returncode == 1
    assert robot.health("--live").returncode == 0
    assert robot.health("--drain").returncode == 0
    robot.sends()
    assert robot.ended() == 0
