"""A model on a server is left at once when nobody wants its answer any more."""

import itertools
import threading

import pytest
from guards import HUNG_S
from llm_server import CHAT, GOOD, Reply, ask, never, serving

from edgevox.core.cancel import CancelToken
from edgevox.core.servers.errors import ServerFailed


def test_cancelling_ends_the_answer_within_a_token_and_tells_the_server() -> None:
    def endless(reply: Reply) -> None:
        reply.stream()
        while not reply.over.wait(0.02):
            reply.piece("a")

    with serving(endless) as server:
        token = CancelToken()
        answer = server.model().generate(CHAT, grammar=None, max_tokens=999, token=token)
        assert len(list(itertools.islice(answer, 5))) == 5
        token.cancel()
        assert len(list(answer)) <= 1
        assert server.gone.wait(HUNG_S)


@pytest.mark.parametrize("begin", [lambda reply: None, lambda reply: reply.stream()])
def test_cancelling_does_not_wait_for_a_server_that_is_silent(begin) -> None:
    token, silent = CancelToken(), threading.Event()

    def chat(reply: Reply) -> None:
        begin(reply)
        token.cancel()
        reply.hang()
        silent.set()

    with serving(chat) as server:
        assert ask(server.model(), token=token) == ""
        assert not silent.is_set()


def test_cancelling_ends_the_pause_between_attempts() -> None:
    token = CancelToken()
    with serving(lambda reply: (reply.status(503), token.cancel())) as server:
        assert ask(server.model(), token=token) == ""
    assert len(server.asked) == 1


def test_a_token_that_is_already_cancelled_asks_nobody() -> None:
    with serving(GOOD) as server:
        token = CancelToken()
        token.cancel()
        assert ask(server.model(), token=token) == ""
    assert server.routes == []


def test_an_answer_that_nobody_listens_to_is_dropped() -> None:
    def endless(reply: Reply) -> None:
        reply.stream()
        while not reply.over.wait(0.02):
            reply.piece("a")

    with serving(endless) as server:
        answer = server.model().generate(CHAT, grammar=None, max_tokens=999, token=CancelToken())
        next(answer)
        answer.close()
        assert server.gone.wait(HUNG_S)


def test_closing_ends_an_answer_and_later_ones_are_refused() -> None:
    with serving(never) as server:
        model = server.model()
        closer = threading.Timer(0.2, model.close)
        closer.start()
        with pytest.raises(ServerFailed, match="closed"):
            ask(model)
        closer.join()
        with pytest.raises(ServerFailed, match="closed"):
            ask(model)


def test_two_are_served_at_once() -> None:
    both = threading.Barrier(2, timeout=HUNG_S)

    def together(reply: Reply) -> None:
        both.wait()
        reply.answer(["go kitchen!"])

    with serving(together) as server:
        model, answers = server.model(), []
        threads = [threading.Thread(target=lambda: answers.append(ask(model))) for _ in range(2)]
        for one in threads:
            one.start()
        for one in threads:
            one.join()
    assert answers == ["go kitchen!"] * 2
