"""Each test module gets an agent in a process of its own, on a domain of its own."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from agent_process import READY, Agent
from halting import settle
from peer import Peer
from robot_file_rig import lasting


@pytest.fixture(scope="module", autouse=True)
def _localhost():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield


@pytest.fixture(scope="session")
def overlays(request):
    """Where interface packages are that tests build; kept for the next run, for all workers."""
    return Path(request.config.cache.mkdir("interfaces"))


@contextmanager
def starting(domain: int) -> Iterator[Callable[..., Agent]]:
    """Starts agents; ends those that still run, all at once."""
    started: list[Agent] = []

    def start(*arguments: str, robot: str = "robot-apartment", wait: bool = True) -> Agent:
        one = Agent(robot, "--text-mode", "--ros2", "--llm", "none", *arguments, domain=domain)
        started.append(one)
        if wait:
            one.wait_for_line(READY)
        return one

    yield start
    for one in started:
        one.leave()
    for one in started:
        one.terminate()


@pytest.fixture
def agent(domain):
    """Starts agents of a test."""
    with starting(domain) as start:
        yield start


@pytest.fixture
def peer(domain):
    peers: list[Peer] = []

    def join(namespace: str = "/edgevox") -> Peer:
        peers.append(Peer(domain, namespace))
        return peers[-1]

    yield join
    for one in peers:
        one.close()


@pytest.fixture(scope="module")
def shared(_domains):
    """Starts agents that the tests of a module share, on a domain of their own."""
    with starting(next(_domains)) as start:
        yield start


@pytest.fixture(scope="module")
def resident(shared):
    """The agent in the apartment that the tests of a module share."""
    return shared()


@pytest.fixture(scope="module")
def neighbour(resident):
    """The peer of the shared agent: to discover one anew takes seconds."""
    one = Peer(resident.domain)
    yield one
    one.close()


@pytest.fixture
def robot(neighbour):
    """Who talks to the shared agent; whatever is asked for in a test is over after it."""
    yield neighbour
    settle(neighbour)


@pytest.fixture(scope="module")
def interface_robot(resident):
    """The robot of `interface_robot.py`, beside the shared agent, and what it is asked."""
    with lasting(resident.domain) as asked:
        yield asked


@pytest.fixture
def asked(interface_robot, robot):
    """What the interface robot is asked in this test; it obeys again."""
    interface_robot.anew()
    return interface_robot
