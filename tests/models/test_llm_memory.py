"""What an answer took is given back when it ends, also where nobody collects garbage."""

import gc
from collections.abc import Iterator

import pytest
from process_memory import process_memory

from edgevox.agent.llm.language_model import ChatMessage, LanguageModel
from edgevox.core.cancel import CancelToken

pytestmark = pytest.mark.long

LETTER = 'root ::= "a" | "b"'
ANSWERS = 24
MARGIN_MB = 4
"""A sampler of this model takes half a MB: that of each answer, kept, would be 12 MB."""


@pytest.fixture(scope="module")
def context_tokens() -> int:
    return 128


@pytest.fixture
def no_garbage_collected() -> Iterator[None]:
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("no_garbage_collected")
def test_answers_leave_no_memory_behind(model: LanguageModel) -> None:
    def ask(text: str) -> str:
        chat, token = [ChatMessage("user", text)], CancelToken()
        return "".join(model.generate(chat, grammar=LETTER, max_tokens=16, token=token))

    ask("Be kind. " * 25)  # its context is all in memory then
    for number in range(ANSWERS // 3):
        ask(f"Where to, number {number}?")
    before_mb = process_memory().own_mb
    answers = [ask(f"Where to, number {number}?") for number in range(ANSWERS)]

    assert {*answers} <= {"a", "b"}
    assert process_memory().own_mb < before_mb + MARGIN_MB
