"""A real llama-server in another process, with the model that robots have on board."""

import itertools
import logging
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import understanding
from understanding import Command, through_model

from edgevox.agent.llm.base import LanguageModel, Message
from edgevox.agent.llm.endpoint import Address, EndpointModel, FallbackModel
from edgevox.agent.llm.endpoint.errors import Refused
from edgevox.agent.llm.factory import load_model
from edgevox.agent.prompt import examples
from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate

MODEL = "qwen2.5-coder-0.5b-instruct"
SENTENCES = 6
COUNT = [Message("user", "Count, and do not stop.")]
NUMBERS = 'root ::= ([0-9] " "){120}'


class Process:
    def __init__(self, weights: Path) -> None:
        script = Path(__file__).with_name("llama_server.py")
        self._process = subprocess.Popen(
            [sys.executable, str(script), str(weights)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout
        self.url = self._process.stdout.readline().strip()
        assert self.url.startswith("http://"), "the server did not start"

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()


@pytest.fixture(scope="module")
def server() -> Iterator[Process]:
    process = Process(locate(MODEL))
    yield process
    process.kill()


@pytest.fixture(scope="module")
def shared(server: Process) -> Iterator[EndpointModel]:
    model = EndpointModel(Address(server.url, timeout_s=60.0))
    yield model
    model.close()


@pytest.fixture(scope="module")
def on_board() -> Iterator[LanguageModel]:
    model = load_model(locate(MODEL))
    yield model
    model.close()


def some_commands() -> list[Command]:
    for_model = [c for c in understanding.read_commands() if c.by == "model"]
    return for_model[:: len(for_model) // SENTENCES]


def test_the_shared_model_understands_what_the_same_one_on_board_does(shared, on_board) -> None:
    skills, commands = understanding.apartment_skills(), some_commands()

    there = through_model(skills, shared, commands)
    here = through_model(skills, on_board, commands)

    assert [one.calls for one in there] == [one.calls for one in here]
    assert sum(one.right for one in there) >= 0.7 * len(commands)
    assert not [one.invalid for one in there if one.invalid]


@pytest.mark.alone
def test_a_cancelled_answer_frees_the_server_for_the_next(shared: EndpointModel) -> None:
    started_s = time.monotonic()
    whole = list(shared.generate(COUNT, grammar=NUMBERS, max_tokens=300, token=CancelToken()))
    whole_s = time.monotonic() - started_s
    token = CancelToken()
    answer = shared.generate(COUNT, grammar=NUMBERS, max_tokens=300, token=token)
    assert len(list(itertools.islice(answer, 3))) == 3

    token.cancel()
    started_s = time.monotonic()
    after = list(answer)
    list(shared.generate(COUNT, grammar=NUMBERS, max_tokens=1, token=CancelToken()))

    assert len(whole) > 100
    assert len(after) <= 1
    assert time.monotonic() - started_s < whole_s / 2


def test_a_chat_longer_than_the_servers_context_is_refused(shared: EndpointModel) -> None:
    long = [Message("user", "kind " * 6000)]

    with pytest.raises(Refused, match="exceeds"):
        list(shared.generate(long, grammar=None, max_tokens=1, token=CancelToken()))


def test_tokens_are_never_counted_too_low(shared: EndpointModel, on_board: LanguageModel) -> None:
    skills = understanding.apartment_skills()
    said = [one.sentence for code in LANGUAGES for one in examples(skills, (), code)]
    said += ["x 12.345, y -0.5", "🤖 🦾", "ok " * 50]

    assert [t for t in said if shared.count_tokens(t) < on_board.count_tokens(t)] == []


def test_when_the_server_dies_the_one_on_board_answers(on_board, caplog) -> None:
    server = Process(locate("smollm2-135m-instruct"))
    model = FallbackModel(EndpointModel(Address(server.url, timeout_s=5.0)), on_board)
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
    model._shared.close()
