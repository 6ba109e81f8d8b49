"""One language model for 1 to 50 robots: waiting, fairness, refusals.

A real llama-server with the smallest model answers two requests at once, by turns directly and
through HAProxy with `compose/llm-queue/haproxy.cfg`. Each robot has its own address, asks with the
agent's prompt and grammar, asks again five seconds after an answer, and gives up after
`llm_endpoint_timeout`.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from http.client import HTTPConnection
from urllib.parse import urlsplit

from ports import free_port
from waiting import wait_until

from benchmarks import ROOT
from benchmarks.agent.language_model import QUESTIONS
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.many_robots import take_turns, waiting
from edgevox.agent.llm.protocol import grammar
from edgevox.agent.llm.remote_model import Offer, chat_request
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing, locate
from edgevox.robots.flat.apartment import ApartmentRobot

MODEL = "smollm2-135m-instruct"
TABLE = "One language model for many robots"
WAYS = {"straight": "llama-server alone", "queue": "behind the queue with a bound"}
SECONDS = {1: 6, 2: 6, 5: 8, 10: 10, 25: 12, 50: 15}
"""How long so many robots ask."""
PARALLEL, WAITING, WAIT_S, TOKENS = 2, 4, 4.0, 12
TIMEOUT_S = float(Settings.model_fields["llm_endpoint_timeout"].default)


@dataclass(slots=True)
class Robot:
    """What one robot saw, in seconds from a question to what ended its waiting."""

    port: int
    """The server's."""
    address: str
    answered_s: list[float] = field(default_factory=list)
    turned_away_s: list[float] = field(default_factory=list)

    def ask(self, body: bytes) -> None:
        """One question, to the end of its answer, or until it is turned away."""
        began_s = time.monotonic()
        where = (self.address, 0)
        door = HTTPConnection("127.0.0.1", self.port, TIMEOUT_S, source_address=where)
        with closing(door) as server:
            try:
                server.request("POST", "/v1/chat/completions", body)
                reply = server.getresponse()
                first = reply.status == 200 and reply.readline()
                waited_s = time.monotonic() - began_s
                (self.answered_s if first else self.turned_away_s).append(waited_s)
                reply.read()
            except TimeoutError:
                self.turned_away_s.append(time.monotonic() - began_s)


def measure(quick: bool = False) -> Measured:
    """All numbers of robots, both ways."""
    haproxy = shutil.which("haproxy", path=f"{os.environ['PATH']}:/usr/sbin")
    if haproxy is None:
        raise NotHere("HAProxy is missing: apt install haproxy")
    bodies, figures = _questions(), list[Figure]()
    with ExitStack() as stack:
        server = stack.enter_context(_server())
        ports = {"straight": server, "queue": stack.enter_context(_door(haproxy, server))}
        for body in bodies[:PARALLEL]:  # the prompt is read once for all, as a robot primes it
            Robot(server, "127.0.0.1").ask(body)
        for count, seconds in [(1, 2), (5, 3)] if quick else SECONDS.items():
            for way, port in ports.items():
                robots = [Robot(port, f"127.0.1.{number}") for number in range(1, count + 1)]
                lasted_s = take_turns(robots, bodies, seconds, Robot.ask)
                figures += _figures(way, robots, lasted_s)
    return Measured(figures=tuple(figures))


def _questions() -> list[bytes]:
    """Requests as the apartment's agent makes them."""
    interpreter = Interpreter(build_agents(ApartmentRobot()), Bus(), SystemClock())
    offer, rules = Offer(MODEL, "llama-server"), grammar()
    chats = [interpreter.chat(one) for one in QUESTIONS]
    return [json.dumps(chat_request(offer, one, rules, TOKENS)).encode() for one in chats]


@contextmanager
def _server() -> Iterator[int]:
    """A llama-server; its port."""
    try:
        weights = locate(MODEL)
    except ModelMissing as error:
        raise NotHere(str(error)) from None
    script = ROOT / "tests" / "models" / "llama_server.py"
    command = [sys.executable, str(script), str(weights), str(os.cpu_count()), str(PARALLEL)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout
            yield urlsplit(process.stdout.readline().strip()).port or 0
        finally:
            process.kill()


@contextmanager
def _door(haproxy: str, server: int) -> Iterator[int]:
    """HAProxy before it; its port."""
    port = free_port()
    told = {
        "LLM_QUEUE_BIND": f"127.0.0.1:{port}",
        "LLM_QUEUE_METRICS_BIND": f"127.0.0.1:{free_port()}",
        "LLM_QUEUE_SERVER": f"127.0.0.1:{server}",
        "LLM_QUEUE_PARALLEL": str(PARALLEL),
        "LLM_QUEUE_LENGTH": str(WAITING),
        "LLM_QUEUE_WAIT": f"{WAIT_S * 1000:.0f}ms",
        "LLM_QUEUE_PER_ROBOT": "2",
    }
    config = str(ROOT / "compose" / "llm-queue" / "haproxy.cfg")
    with subprocess.Popen(
        [haproxy, "-db", "-f", config], env={**os.environ, **told}, stdout=subprocess.DEVNULL
    ) as process:
        try:
            wait_until(lambda: _listens(port))
            yield port
        finally:
            process.kill()


def _listens(port: int) -> bool:
    with closing(HTTPConnection("127.0.0.1", port)) as door:
        try:
            door.request("GET", "/queue")
            return door.getresponse().status == 200
        except OSError:
            return False


def fairness(shares: Sequence[float]) -> float:
    """Jain's index: 1 where all have the same, one divided by their number where one has all."""
    squares = sum(one * one for one in shares)
    return sum(shares) ** 2 / (len(shares) * squares) if squares else 1.0


def _figures(way: str, robots: Sequence[Robot], seconds: float) -> Iterator[Figure]:
    answered = [one for robot in robots for one in robot.answered_s]
    turned = [one for robot in robots for one in robot.turned_away_s]
    shares = [len(robot.answered_s) for robot in robots]
    count = len(robots)
    row = f"{count} robot{'s' * (count > 1)}, {WAYS[way]}"
    for key, column, unit, value in (
        ("rate", "answers", "/s", len(answered) / seconds),
        *waiting(answered + turned),
        ("turned", "turned away or given up", "%", 100 * len(turned) / len(answered + turned)),
        ("fairness", "Jain's index", "", fairness(shares)),
    ):
        yield Figure.of(f"{key}.{way}.{count}", TABLE, row, [value], unit, column=column)
