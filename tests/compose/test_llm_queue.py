"""The door before a shared language model: a real HAProxy with our file, many robots' addresses."""

import http.client
import json
import os
import re
import socket
import subprocess
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest
from guards import HUNG_S
from llm_server import Reply, ask, good, serving
from ports import free_port
from stacks import ROOT
from waiting import wait_until

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.remote_model import EndpointModel, FallbackModel
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import ServerBusy, Unreachable

CONFIG = ROOT / "compose" / "llm-queue" / "haproxy.cfg"
FULL = {429, 503}


@contextmanager
def door(server_port: int, *, parallel: int, length: int, wait: str) -> Iterator[tuple[int, int]]:
    """The port at which robots ask, and that of its metrics."""
    port, metrics = free_port(), free_port()
    told = {
        "LLM_QUEUE_METRICS_BIND": f"127.0.0.1:{metrics}",
        "LLM_QUEUE_BIND": f"127.0.0.1:{port}",
        "LLM_QUEUE_SERVER": f"127.0.0.1:{server_port}",
        "LLM_QUEUE_PARALLEL": str(parallel),
        "LLM_QUEUE_LENGTH": str(length),
        "LLM_QUEUE_WAIT": wait,
        "LLM_QUEUE_PER_ROBOT": "2",
    }
    path = f"{os.environ['PATH']}:/usr/sbin"  # where Debian has it, and not every user looks
    with subprocess.Popen(
        ["haproxy", "-db", "-f", str(CONFIG)],
        env={**os.environ, **told, "PATH": path},
        stdout=subprocess.DEVNULL,
    ) as process:
        try:
            wait_until(lambda: _answers(port))
            yield port, metrics
        finally:
            process.terminate()


def _answers(port: int) -> bool:
    try:
        return status(port, 1, "GET", "/queue") == 200
    except OSError:
        return False


def _waiting(metrics: int) -> int:
    """How many wait before the server, as HAProxy counts them."""
    connection = http.client.HTTPConnection("127.0.0.1", metrics)
    connection.request("GET", "/metrics")
    text = connection.getresponse().read().decode()
    connection.close()
    return int(re.search(r'haproxy_backend_current_queue{proxy="llm"} (\d+)', text)[1])


def status(port: int, robot: int, method: str = "POST", route: str = "/v1/chat/completions") -> int:
    """What a robot with an address of its own is answered."""
    connection = http.client.HTTPConnection(
        "127.0.0.1", port, source_address=(f"127.0.1.{robot}", 0)
    )
    try:
        connection.request(
            method, route, json.dumps({"robot": robot}) if method == "POST" else None
        )
        reply = connection.getresponse()
        reply.read()
        return reply.status
    finally:
        connection.close()


class Held:
    """A chat that is answered when it is told to, and that counts who came in."""

    def __init__(self) -> None:
        self.go = threading.Event()
        self._came = threading.Semaphore(0)

    def __call__(self, reply: Reply) -> None:
        self._came.release()
        self.go.wait()
        reply.answer(("go kitchen!",))

    def came(self) -> None:
        self._came.acquire()


def test_an_answer_comes_through_as_the_server_gave_it() -> None:
    with (
        serving(good("go ", "kitchen!")) as server,
        door(server.port, parallel=2, length=2, wait="60s") as (port, _),
    ):
        model = EndpointModel(Address(f"http://127.0.0.1:{port}"))
        assert ask(model) == "go kitchen!"
        model.close()


@pytest.mark.parametrize(
    ("method", "route"),
    [
        ("GET", "/slots"),
        ("GET", "/metrics"),
        ("GET", "/v1/chat/completions"),
        ("POST", "/v1/models"),
        ("POST", "/v1/completions"),
        ("POST", "/v1/chat/completions/"),
        ("POST", "//v1/chat/completions"),
    ],
)
def test_robots_reach_nothing_of_the_server_but_what_they_ask(method: str, route: str) -> None:
    with (
        serving(good("go ", "kitchen!")) as server,
        door(server.port, parallel=1, length=2, wait="60s") as (port, metrics),
    ):
        assert status(port, 1, method, route) == 404
        assert not server.asked
        assert status(metrics, 1) == 404
        assert status(port, 1) == 200


def test_no_more_get_in_than_it_answers_at_once_and_no_more_wait_than_the_bound() -> None:
    held = Held()
    with (
        serving(held) as server,
        door(server.port, parallel=1, length=2, wait="600s") as (port, _),
        ThreadPoolExecutor() as robots,
    ):
        first = robots.submit(status, port, 1)
        held.came()
        rest = [robots.submit(status, port, robot) for robot in range(2, 8)]
        wait_until(lambda: sum(one.done() for one in rest) == 4)

        assert {one.result() for one in rest if one.done()} == {429}
        assert len(server.asked) == 1
        held.go.set()
        served = [one.result() for one in (first, *rest)]
        assert sorted(served) == [200] * 3 + [429] * 4


def test_who_sends_only_the_head_of_a_question_takes_no_place() -> None:
    with (
        serving(good("go ", "kitchen!")) as server,
        door(server.port, parallel=1, length=2, wait="60s") as (port, _),
        socket.create_connection(("127.0.0.1", port), source_address=("127.0.1.9", 0)) as slow,
    ):
        slow.sendall(b"POST /v1/chat/completions HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n{")
        assert status(port, 1) == 200
        assert slow.recv(12) == b"HTTP/1.1 408"
        assert len(server.asked) == 1


def test_whoever_waits_too_long_is_told_that_it_is_full() -> None:
    held = Held()
    with (
        serving(held) as server,
        door(server.port, parallel=1, length=9, wait="100ms") as (port, _),
        ThreadPoolExecutor() as robots,
    ):
        first = robots.submit(status, port, 1)
        held.came()
        model = EndpointModel(Address(f"http://127.0.0.1:{port}"))
        with pytest.raises(ServerBusy, match="too long in the queue"):
            ask(model, grammar=None)
        model.close()
        held.go.set()
        assert first.result() == 200


def test_one_robot_that_asks_many_things_at_once_does_not_fill_the_queue() -> None:
    held = Held()
    with (
        serving(held) as server,
        door(server.port, parallel=1, length=9, wait="600s") as (port, _),
        ThreadPoolExecutor() as robots,
    ):
        greedy = [robots.submit(status, port, 1) for _ in range(6)]
        wait_until(lambda: sum(one.done() for one in greedy) == 4)
        other = robots.submit(status, port, 2)
        held.go.set()

        assert other.result() == 200
        assert sorted(one.result() for one in greedy) == [200] * 2 + [429] * 4


def test_the_robot_that_asked_less_is_let_in_first() -> None:
    first, chat = Held(), good("go kitchen!")
    with (
        serving(*[chat] * 5, first, chat) as server,
        door(server.port, parallel=1, length=9, wait="600s") as (port, metrics),
        ThreadPoolExecutor() as robots,
    ):
        assert [status(port, 1) for _ in range(5)] == [200] * 5
        holder = robots.submit(status, port, 9)
        first.came()
        asked = [robots.submit(status, port, robot) for robot in (1, 2)]
        wait_until(lambda: _waiting(metrics) == len(asked))
        first.go.set()
        assert [one.result() for one in (holder, *asked)] == [200] * 3
        assert [one["robot"] for one in server.asked[-2:]] == [2, 1]


def test_a_server_that_is_gone_has_failed_and_is_not_full() -> None:
    with door(free_port(), parallel=1, length=1, wait="60s") as (port, _):
        wait_until(lambda: status(port, 1) == 502)
        model = EndpointModel(Address(f"http://127.0.0.1:{port}"), pauses_s=())
        with pytest.raises(Unreachable, match="gone"):
            ask(model)
        model.close()


def test_a_stop_word_does_not_wait_in_the_queue_and_leaves_its_place_to_others() -> None:
    held, halted = Held(), threading.Event()
    with (
        serving(held) as server,
        door(server.port, parallel=1, length=9, wait="600s") as (port, metrics),
        ThreadPoolExecutor() as robots,
    ):
        first = robots.submit(status, port, 1)
        held.came()
        shared = EndpointModel(Address(f"http://127.0.0.1:{port}", timeout_s=HUNG_S))
        model = FallbackModel(shared, None)
        robot = Conversation(
            [Agent("edgevox", "Be brief.")],
            Bus(),
            halt=lambda _: bool(halted.set()),
            model=model,
        )
        robot.start()
        try:
            robot.submit(TextInput("why does ice float on water?"))
            wait_until(lambda: _waiting(metrics) == 1)
            robot.submit(TextInput("stop"))
            assert halted.is_set()
            wait_until(lambda: _waiting(metrics) == 0)
            assert not first.done()
        finally:
            held.go.set()
            robot.close()
            model.close()
