"""What holds for all tests: on whatever machine, and beside others in workers of pytest-xdist."""

import ctypes
import gc
import itertools
import os
import random
import socket
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from beside import Room, Scheduling, in_turns
from failed_subscribers import FAILED, FailedSubscribers
from hypothesis import HealthCheck, settings

from edgevox.agent.nlu import encoder
from edgevox.ops.machine import return_memory

# How long an example takes is the machine's business; what must be quick is a benchmark.
SLOW = [HealthCheck.too_slow]
settings.register_profile("search", deadline=None, suppress_health_check=SLOW)
# The same examples in every run, and half as many as usual: who changed nothing must not find a
# test failed. `make steady` searches on.
settings.register_profile(
    "same", settings.get_profile("search"), derandomize=True, database=None, max_examples=50
)
settings.load_profile(os.environ.get("TEST_EXAMPLES", "same"))
# A busy machine may take longer to leave than a container's engine waits; what hangs is found by
# the guards of each test.
os.environ.setdefault("EDGEVOX_LEAVE_S", "120")
# No agent that a test starts recalls, or changes, what this machine's own robot remembers.
os.environ["XDG_STATE_HOME"] = str(Path(tempfile.gettempdir(), f"edgevox-tests-{os.getpid()}"))

DDS_PORT, DOMAIN_GAIN = 7410, 250
"""Where the first participant of ROS 2's domain 0 hears of others; then every second."""
PARTICIPANTS = 4
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
KEPT_BYTES = 32 * 2**20
"""What is smaller is given back after a file of tests: at once, it takes half of a test's time."""


def pytest_configure(config: pytest.Config) -> None:
    return_memory()  # as our programs do
    for what in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD):
        ctypes.CDLL(None).mallopt(what, KEPT_BYTES)
    config.addinivalue_line("markers", "alone: no other test runs meanwhile; it measures time")
    config.addinivalue_line("markers", "long: `make test-all` runs it, `make test` does not")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[object]:
    """What was imported and found stays to the end: no garbage collection looks at it again."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if hasattr(config, "workerinput"):
        items[:] = in_turns((item.path, item) for item in items)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Scheduling | None:
    return Scheduling(config, log) if config.getoption("dist") == "loadfile" else None


@pytest.fixture(autouse=True)
def _environment_of_its_own() -> Iterator[None]:
    """A program that a test runs in this process may set variables; the next test has others."""
    before = dict(os.environ)
    yield
    for name in os.environ.keys() - before.keys():
        del os.environ[name]
    os.environ.update(before)


@pytest.fixture(scope="module", autouse=True)
def _memory_of_a_file_is_given_back() -> Iterator[None]:
    """A worker runs many files: what one has loaded must not stay until the end.

    Until then the agents of a file share the encoder, which is most of what it takes to build one.
    """
    read = encoder.Encoder
    encoder.Encoder = cache(read)
    yield
    encoder.Encoder = read
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)


@pytest.fixture(autouse=True)
def failed_subscribers() -> Iterator[FailedSubscribers]:
    """A subscriber of a bus that fails, fails the test; one that expects it takes the failure."""
    yield FAILED
    if failed := FAILED.take():
        pytest.fail(f"a subscriber of a bus failed, and no test took it:\n{failed}", pytrace=False)


@pytest.fixture(scope="session")
def worker(request: pytest.FixtureRequest) -> tuple[int, int]:
    """Which worker this is, from 0, and of how many; the only one where none are beside it."""
    told = getattr(request.config, "workerinput", {"workerid": "gw0", "workercount": 1})
    return int(told["workerid"].removeprefix("gw")), told["workercount"]


@pytest.fixture(scope="session")
def _domains(worker: tuple[int, int]) -> Iterator[int]:
    """Every module its own: a process that was killed haunts its domain for 20 s.

    After all of them the first is anybody's again.
    """
    number, workers = worker
    domains = list(range(1 + number, 100, workers))
    random.shuffle(domains)
    return filter(_is_free, itertools.cycle(domains))


def _is_free(domain: int) -> bool:
    """Whether nobody on this machine is there: somebody's robot, or one that was left behind."""
    try:
        for participant in range(PARTICIPANTS):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
                one.bind(("", DDS_PORT + DOMAIN_GAIN * domain + 2 * participant))
    except OSError:
        return False
    return True


@pytest.fixture(scope="module")
def domain(_domains: Iterator[int]) -> int:
    """A domain of ROS 2 that is this module's."""
    return next(_domains)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """A test that must be alone waits until the other workers' tests are over, and they for it."""
    if not hasattr(item.config, "workerinput"):
        return (yield)
    room = Room(Path(item.config.option.basetemp).parent)  # where the workers' own folders lie
    with room.alone() if item.get_closest_marker("alone") else room.shared():
        return (yield)
