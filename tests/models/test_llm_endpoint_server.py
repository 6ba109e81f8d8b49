"""A real llama-server in another process, with the smallest model, as a fleet may share one."""

import itertools
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from corpus_robots import skills_of_robots
from guards import HUNG_S

from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import ChatMessage, LanguageModel
from edgevox.agent.llm.protocol import Protocol
from edgevox.agent.llm.remote_model import EndpointModel, FallbackModel
from edgevox.agent.phrases.load import phrasebook
from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import RequestRefused
from edgevox.models import locate

MODEL = "smollm2-135m-instruct"
ASKED = "how do you do?"
COUNT = [ChatMessage("user", "Count, and do not stop.")]
NUMBERS = 'root ::= ([0-9] " "){30}'


class Process:
    def __init__(self, weights: Path, threads: int) -> None:
        script = Path(__file__).with_name("llama_server.py")
        self._process = subprocess.Popen(
            [sys.executable, str(script), str(weights), str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout
        self.url = self._process.stdout.readline().strip()
        assert self.url.startswith("http://"), "the server did not start"

    def computed_s(self) -> float:
        """How long it has computed: what else the machine does does not matter."""
        stat = Path(f"/proc/{self._process.pid}/stat").read_text(encoding="ascii")
        user, system = stat.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()


@pytest.fixture(scope="module")
def server(threads: int) -> Iterator[Process]:
    process = Process(locate(MODEL), threads)
    yield process
    process.kill()


@pytest.fixture(scope="module")
def shared(server: Process) -> Iterator[EndpointModel]:
    model = EndpointModel(Address(server.url, timeout_s=HUNG_S))
    yield model
    model.close()


@pytest.fixture(scope="module")
def on_board(threads: int) -> Iterator[LanguageModel]:
    model = load_model(locate(MODEL), threads=threads)
    yield model
    model.close()


@pytest.mark.long
def test_the_shared_model_answers_as_the_same_one_on_board_does(
    shared: EndpointModel, on_board: LanguageModel
) -> None:
    protocol = Protocol("You keep the notes of a household.")

    def answer(model: LanguageModel) -> str:
        chat = [protocol.opening[0], ChatMessage("user", ASKED)]
        token = CancelToken()
        grammar = protocol.grammar
        return "".join(model.generate(chat, grammar=grammar, max_tokens=24, token=token))

    assert answer(shared) == answer(on_board) != ""


def test_a_cancelled_answer_frees_the_server_for_the_next(
    server: Process, shared: EndpointModel
) -> None:
    before_s = server.computed_s()
    whole = list(shared.generate(COUNT, grammar=NUMBERS, max_tokens=300, token=CancelToken()))
    whole_s = server.computed_s() - before_s
    token = CancelToken()
    answer = shared.generate(COUNT, grammar=NUMBERS, max_tokens=300, token=token)
    assert len(list(itertools.islice(answer, 3))) == 3

    token.cancel()
    before_s = server.computed_s()
    after = list(answer)
    list(shared.generate(COUNT, grammar=NUMBERS, max_tokens=1, token=CancelToken()))

    assert len(whole) > 25
    assert len(after) <= 1
    assert server.computed_s() - before_s < whole_s / 2


def test_a_chat_longer_than_the_servers_context_is_refused(shared: EndpointModel) -> None:
    long = [ChatMessage("user", "kind " * 6000)]

    with pytest.raises(RequestRefused, match="exceeds"):
        list(shared.generate(long, grammar=None, max_tokens=1, token=CancelToken()))


def test_tokens_are_never_counted_too_low(shared: EndpointModel, threads: int) -> None:
    small = load_model(locate("qwen2.5-coder-0.5b-instruct"), context_tokens=64, threads=threads)
    every = skills_of_robots()["robot-apartment"].values()
    books = map(phrasebook, LANGUAGES)
    said = [e.sentence for book in books for one in every for e in book.examples(one)]
    said += ["x 12.345, y -0.5", "🤖 🦾", "ok " * 50]

    assert [t for t in said if shared.count_tokens(t) < small.count_tokens(t)] == []
    small.close()


def test_when_the_server_dies_the_one_on_board_answers(on_board, threads, caplog) -> None:
    server = Process(locate(MODEL), threads)
    shared = EndpointModel(Address(server.url, timeout_s=HUNG_S))
    model = FallbackModel(shared, on_board)
    rooms = 'root ::= "kitchen" | "bedroom"'
    chat = [ChatMessage("user", "Where do people cook? In the kitchen or in the bedroom?")]

    def ask() -> str:
        return "".join(model.generate(chat, grammar=rooms, max_tokens=8, token=CancelToken()))

    assert ask() in ("kitchen", "bedroom")
    assert not caplog.records
    server.kill()
    with caplog.at_level(logging.WARNING):
        assert {ask(), ask()} <= {"kitchen", "bedroom"}
    assert len(caplog.records) == 1
    shared.close()
