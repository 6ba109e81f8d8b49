"""What a peer reads on /diagnostics: who is well, who is not, and that it comes back."""

import os
import signal
from pathlib import Path

import pytest
from agent_process import AGENT, READY, Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from interop_rig import Messages
from peer import RELIABLE, Peer
from waiting import wait_until

COMPONENTS = ["audio", "stt", "llm", "tts", "sim"]
COMPONENTS += ["executor", "presence", "interlock", "console", "policy", "disk", "process"]
EDGEVOX = str(Path(AGENT).with_name("edgevox"))


class Watcher(Messages):
    """Listens to /diagnostics, and waits for what is said there."""

    def __init__(self, peer: Peer) -> None:
        super().__init__()
        subscription = peer.node.create_subscription(
            DiagnosticArray, "/diagnostics", self.take, RELIABLE
        )
        wait_until(lambda: subscription.get_publisher_count() > 0, "/diagnostics")

    def status(self, name: str, level: bytes, since: int = 0) -> DiagnosticStatus:
        def found(array: DiagnosticArray) -> list[DiagnosticStatus]:
            return [one for one in array.status if (one.name, one.level) == (name, level)]

        return found(self.wait_for(found, since=since))[0]


@pytest.fixture
def watcher(peer):
    return lambda: Watcher(peer())


def values(status: DiagnosticStatus) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def stamp_s(array: DiagnosticArray) -> float:
    return array.header.stamp.sec + array.header.stamp.nanosec / 1e9


def test_each_component_says_once_a_second_at_most_how_it_is(agent, watcher):
    agent()
    arrays = watcher().wait_for_more(3).messages
    assert stamp_s(arrays[2]) - stamp_s(arrays[0]) > 0.95, "one may be late, and none is made up"
    last = arrays[-1].status
    assert [one.name for one in last] == [f"/edgevox/edgevox: {name}" for name in COMPONENTS]
    assert {one.hardware_id for one in last} == {"/edgevox/edgevox"}
    said = {one.name.rpartition(" ")[2]: one for one in last}
    assert said["audio"].message.startswith("off")
    assert said["sim"].level in (DiagnosticStatus.OK, DiagnosticStatus.WARN)
    assert values(said["sim"])["body"] == "robot-apartment"
    assert float(values(said["sim"])["battery"]) > 0.5
    assert int(values(said["process"])["memory_mib"]) > 10


def test_two_robots_of_one_domain_stay_apart(agent, watcher):
    for namespace in ("/robot1", "/robot2"):
        agent("--ros2-namespace", namespace)
    heard = watcher()
    for namespace in ("/robot1", "/robot2"):
        heard.status(f"{namespace}/edgevox: disk", DiagnosticStatus.OK)


def test_an_agent_without_a_robot_says_so_too(domain, watcher):
    talker = Agent("--text-mode", "--ros2", "--llm=none", domain=domain, program=EDGEVOX)
    try:
        status = watcher().status("/edgevox/edgevox: sim", DiagnosticStatus.OK)
        assert status.message == "off: no robot"
    finally:
        talker.terminate()


def test_a_robot_that_falls_silent_is_an_error_until_it_is_heard_again(agent, watcher, domain):
    agent(robot="robot-external")
    heard = watcher()
    name = "/edgevox/edgevox: sim"
    assert "odom" in heard.status(name, DiagnosticStatus.ERROR).message
    robot = Agent(
        "robot-apartment",
        "--text-mode",
        "--ros2",
        "--llm=none",
        "--ros2-namespace=/",
        domain=domain,
    )
    try:
        robot.wait_for_line(READY)
        heard.status(name, DiagnosticStatus.OK)
        since = len(heard.messages)
        os.kill(robot.process.pid, signal.SIGSTOP)
        heard.status(name, DiagnosticStatus.ERROR, since)
        since = len(heard.messages)
        os.kill(robot.process.pid, signal.SIGCONT)
        heard.status(name, DiagnosticStatus.OK, since)
    finally:
        os.kill(robot.process.pid, signal.SIGCONT)
        robot.terminate()
