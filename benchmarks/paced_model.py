"""A language model that takes the time of the small one and no work: an OpenAI-compatible server.

What an agent's own work for a turn costs is lost in the noise of a model on the same processor.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import shared_with_tests  # noqa: F401 - finds the tests' modules
from llm_server import Reply, serving

from edgevox.agent.grammar import SAY

FIRST_S, BETWEEN_S = 0.35, 0.025
"""What Qwen2.5-Coder 0.5B takes on two cores until its first token, and between two."""
ANSWER = "I am a robot and I drive through the rooms of this house ."


def answer(reply: Reply) -> None:
    """One answer in words, at the pace of a model."""
    pause = threading.Event()
    pause.wait(FIRST_S)
    reply.stream()
    reply.piece(SAY.strip())
    for word in ANSWER.split():
        reply.piece(f" {word}")
        pause.wait(BETWEEN_S)
    reply.piece(None, "stop")
    reply.raw("data: [DONE]\n\n")


@contextmanager
def paced_model() -> Iterator[str]:
    """Have one that answers; its address."""
    with serving(answer) as server:
        yield server.url
