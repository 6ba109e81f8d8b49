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
COMPONENTS += ["executor", "presence", "interlock", "console", "recordings", "recorder"]
COMPONENTS += ["policy", "disk", "clock", "process"]
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


@pytest.fixture(scope="module")
def body(resident):
    """A robot of ours that the shared agent drives over ROS 2; it is an agent, too."""
    one = Agent(
        "robot-apartment",
        *("--text-mode", "--ros2", "--llm=none", "--ros2-namespace=/"),
        domain=resident.domain,
    )
    one.wait_for_line(READY)
    yield one
    one.terminate()


@pytest.fixture(scope="module")
def resident(shared):
    return shared(robot="robot-external")


@pytest.fixture
def heard(neighbour):
    return Watcher(neighbour)


def values(status: DiagnosticStatus) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def stamp_s(array: DiagnosticArray) -> float:
    return array.header.stamp.sec + array.header.stamp.nanosec / 1e9


def test_each_component_says_once_a_second_at_most_how_it_is(body, heard):
    heard.status("/edgevox: disk", DiagnosticStatus.OK)
    ours = [one for one in heard.messages if one.status[0].name.startswith("/edgevox: ")]
    since = len(heard.messages)
    for _ in range(2):
        ours.append(
            heard.wait_for(lambda one: one.status[0].name.startswith("/edgevox: "), since=since)
        )
        since = heard.messages.index(ours[-1]) + 1
    assert stamp_s(ours[-1]) - stamp_s(ours[-3]) > 0.95, "one may be late, and none is made up"
    last = ours[-1].status
    assert [one.name for one in last] == [f"/edgevox: {name}" for name in COMPONENTS]
    assert {one.hardware_id for one in last} == {"/edgevox"}
    said = {one.name.rpartition(" ")[2]: one for one in last}
    assert said["audio"].message.startswith("off")
    assert said["sim"].level in (DiagnosticStatus.OK, DiagnosticStatus.WARN)
    assert values(said["sim"])["body"] == "robot-apartment"
    assert float(values(said["sim"])["battery"]) > 0.5
    assert int(values(said["process"])["memory_mib"]) > 10


@pytest.mark.long
def test_an_agent_without_a_robot_says_so_too(domain, peer):
    talker = Agent("--text-mode", "--ros2", "--llm=none", domain=domain, program=EDGEVOX)
    try:
        status = Watcher(peer()).status("/edgevox/edgevox: sim", DiagnosticStatus.OK)
        assert status.message == "off: no robot"
    finally:
        talker.terminate()


def test_a_robot_that_falls_silent_is_an_error_until_it_is_heard_again(body, heard):
    """And of two agents on one domain each speaks for itself."""
    name = "/edgevox/edgevox: sim"
    heard.status(name, DiagnosticStatus.OK)
    try:
        since = len(heard.messages)
        os.kill(body.process.pid, signal.SIGSTOP)
        assert "odom" in heard.status(name, DiagnosticStatus.ERROR, since).message
        since = len(heard.messages)
        os.kill(body.process.pid, signal.SIGCONT)
        heard.status(name, DiagnosticStatus.OK, since)
        heard.status("/edgevox: disk", DiagnosticStatus.OK, since)
    finally:
        os.kill(body.process.pid, signal.SIGCONT)
