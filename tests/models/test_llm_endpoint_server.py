"""A real llama-server in another process, with the model that robots have on board."""

import itertools
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import understanding
from guards import HUNG_S
from understanding import Command, through_model

from edgevox.agent.llm.base import LanguageModel, Message
from edgevox.agent.llm.endpoint import Address, EndpointModel, FallbackModel
from edgevox.agent.llm.endpoint.errors import Refused
from edgevox.agent.prompt import examples
from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate

MODEL = "qwen2.5-coder-0.5b-instruct"
SENTENCES = 6
COUNT = [Message("user", "Count, and do not stop.")]
NUMBERS = 'root ::= ([0-9] " "){60}'


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


def some_commands() -> list[Command]:
    for_model = [c for c in understanding.read_commands() if c.by == "model"]
    return for_model[:: len(for_model) // SENTENCES]


def test_the_shared_model_understands_what_the_same_one_on_board_does(shared, apartment) -> None:
    skills, commands = understanding.apartment_skills(), some_commands()

    there = through_model(skills, shared, commands)
    here = apartment.understands(commands)

    assert [one.calls for one in there] == [one.calls for one in here]
    assert sum(one.right for one in there) >= 0.7 * len(commands)
    assert not [one.invalid for one in there if one.invalid]


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

    assert len(whole) > 50
    assert len(after) <= 1
    assert server.computed_s() - before_s < whole_s / 2


def test_a_chat_longer_than_the_servers_context_is_refused(shared: EndpointModel) -> None:
    long = [Message("user", "kind " * 6000)]

    with pytest.raises(Refused, match="exceeds"):
        list(shared.generate(long, grammar=None, max_tokens=1, token=CancelToken()))


def test_tokens_are_never_counted_too_low(shared: EndpointModel, small: LanguageModel) -> None:
    skills = understanding.apartment_skills()
    said = [one.sentence for code in LANGUAGES for one in examples(skills, (), code)]
    said += ["x 12.345, y -0.5", "🤖 🦾", "ok " * 50]

    assert [t for t in said if shared.count_tokens(t) < small.count_tokens(t)] == []


def test_when_the_server_dies_the_one_on_board_answers(small, threads, caplog) -> None:
    server = Process(locate("smollm2-135m-instruct"), threads)
    shared = EndpointModel(Address(server.url, timeout_s=HUNG_S))
    model = FallbackModel(shared, small)
    rooms = 'root ::= "kitchen" | "bedroom"'
    chat = [Message("user", "Where do people cook? In the kitchen or in the bedroom?")]

    def ask() -> str:
        return "".join(model.generate(chat, grammar=rooms, max_tokens=8, token=CancelToken()))

    assert ask() in ("kitchen", "bedroom")
    assert not caplog.records
    server.kill()
    with caplog.at_level(logging.WARNING):
        assert {ask(), ask()} <= {"kitchen", "bedroom"}
    assert len(caplog.records) == 1
    shared.close()
