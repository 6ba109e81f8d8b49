"""Each test module gets an agent in a process of its own, on a domain of its own."""

import itertools
import random
import socket
from pathlib import Path

import pytest
from agent_process import READY, Agent
from peer import Peer

DDS_PORT, DOMAIN_GAIN = 7410, 250
"""Where the first participant of domain 0 hears of others; the next has the port after next."""
PARTICIPANTS = 4


@pytest.fixture(scope="module", autouse=True)
def _localhost():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield


@pytest.fixture(scope="session")
def _domains(worker):
    """Every module its own: a process that was killed haunts its domain for 20 s.

    After all of them the first is anybody's again.
    """
    number, workers = worker
    domains = list(range(1 + number, 100, workers))
    random.shuffle(domains)
    return filter(_is_free, itertools.cycle(domains))


def _is_free(domain):
    """Whether nobody on this machine is there: somebody's robot, or one that was left behind."""
    try:
        for participant in range(PARTICIPANTS):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
                one.bind(("", DDS_PORT + DOMAIN_GAIN * domain + 2 * participant))
    except OSError:
        return False
    return True


@pytest.fixture(scope="module")
def domain(_domains):
    return next(_domains)


@pytest.fixture(scope="session")
def overlays(request):
    """Where interface packages are that tests build; kept for the next run, for all workers."""
    return Path(request.config.cache.mkdir("interfaces"))


@pytest.fixture
def agent(domain):
    """Starts agents; ends those that still run."""
    started: list[Agent] = []

    def start(*arguments: str, robot: str = "robot-apartment", wait: bool = True) -> Agent:
        one = Agent(robot, "--text-mode", "--ros2", "--llm", "none", *arguments, domain=domain)
        started.append(one)
        if wait:
            one.wait_for_line(READY)
        return one

    yield start
    for one in started:
        one.terminate()


@pytest.fixture
def peer(domain):
    peers: list[Peer] = []

    def join(namespace: str = "/edgevox") -> Peer:
        peers.append(Peer(domain, namespace))
        return peers[-1]

    yield join
    for one in peers:
        one.close()
