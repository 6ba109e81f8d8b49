"""A model on a server that fails in every way: what is tried again, what is told, how soon."""

import json
import socket
import time

import pytest
from guards import HUNG_S
from llm_server import CHAT, GOOD, ROOMS, Chat, Reply, ask, failing, good, never, serving

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.remote_model import EndpointModel
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import (
    OddAnswer,
    RequestRefused,
    ServerBusy,
    ServerFailed,
    Unreachable,
    Unusable,
)


@pytest.mark.parametrize("pieces", [("Sure! go kitchen!",), ("go ", "moon!"), ("",), ()])
def test_an_answer_that_leaves_the_grammar_does_not_come_through(pieces) -> None:
    with serving(good(*pieces)) as server, pytest.raises(OddAnswer):
        ask(server.model())
    assert len(server.asked) == 1


def test_what_is_babbled_after_a_whole_answer_is_left_out() -> None:
    with serving(good("go ", "kitchen!\n\nuser: and then?", "!")) as server:
        assert ask(server.model()) == "go kitchen!"


def test_a_grammar_that_does_not_parse_is_refused() -> None:
    with serving(GOOD) as server, pytest.raises(ModelFailed, match="grammar"):
        ask(server.model(), grammar='root ::= "go')


@pytest.mark.parametrize("code", [408, 425, 500, 502, 503, 504])
def test_what_may_pass_is_tried_again(code: int) -> None:
    with serving(failing(code), GOOD) as server:
        assert ask(server.model()) == "go kitchen!"
    assert len(server.asked) == 2


def test_after_three_attempts_it_is_given_up_with_what_the_server_said() -> None:
    said = json.dumps({"error": {"message": "loading model"}})
    with serving(failing(503, said)) as server, pytest.raises(Unreachable, match="503: loading"):
        ask(server.model())
    assert len(server.asked) == 3


@pytest.mark.parametrize(
    "chat",
    [failing(429, "no"), lambda reply: reply.status(503, "no", Retry_After="2")],
    ids=["too many", "come again"],
)
def test_a_server_that_is_full_is_not_tried_again(chat: Chat) -> None:
    with serving(chat, GOOD) as server, pytest.raises(ServerBusy, match=": no"):
        ask(server.model())
    assert len(server.asked) == 1


@pytest.mark.parametrize(
    ("code", "kind"),
    [
        (400, RequestRefused),
        (413, RequestRefused),
        (401, Unusable),
        (404, Unusable),
        (302, Unusable),
    ],
)
def test_what_would_end_the_same_way_is_not_tried_again(code: int, kind: type) -> None:
    with serving(failing(code, "no")) as server, pytest.raises(kind, match=f"{code}: no"):
        ask(server.model())
    assert len(server.asked) == 1


def test_a_server_that_is_not_there_is_unreachable_within_the_timeout() -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        model = EndpointModel(Address(f"http://127.0.0.1:{unused.getsockname()[1]}"))
        with pytest.raises(Unreachable):
            ask(model)
    model.close()


def test_a_host_without_an_address_is_unreachable() -> None:
    model = EndpointModel(Address("http://nobody.invalid:1", timeout_s=2.0))
    with pytest.raises(Unreachable):
        ask(model)
    model.close()


@pytest.mark.parametrize(
    "chat",
    [
        never,
        lambda reply: (reply.stream(), reply.hang()),
        lambda reply: (reply.raw("HTTP/1.1 200 OK\r\nX-A: "), reply.hang()),
    ],
    ids=["never a byte", "headers only", "half a header"],
)
def test_a_server_that_never_answers_is_given_up_when_the_time_is_over(chat) -> None:
    with serving(chat) as server:
        model, started_s = server.model(timeout_s=0.4), time.monotonic()
        with pytest.raises(Unreachable, match="in time"):
            ask(model)
        assert time.monotonic() - started_s > 0.3


def test_signs_of_life_without_a_token_do_not_buy_time() -> None:
    def breathe(reply: Reply) -> None:
        reply.stream()
        while not reply.over.wait(0.05):
            reply.raw(": still here\n\n")

    with serving(breathe) as server, pytest.raises(Unreachable, match="in time"):
        ask(server.model(timeout_s=0.4))


def test_a_stream_that_stops_amid_the_answer_ends_with_the_timeout() -> None:
    def stall(reply: Reply) -> None:
        reply.stream()
        reply.piece("go ")
        reply.hang()

    with serving(stall) as server:
        answer = server.model(timeout_s=5.0).generate(
            CHAT, grammar=ROOMS, max_tokens=9, token=CancelToken()
        )
        assert next(answer) == "go "
        with pytest.raises(Unreachable, match="in time"):
            next(answer)
        assert len(server.asked) == 1


def test_a_connection_that_breaks_amid_the_answer_is_not_tried_again() -> None:
    def drop(reply: Reply) -> None:
        reply.stream()
        reply.piece("go ")

    with serving(drop) as server:
        answer = server.model().generate(CHAT, grammar=ROOMS, max_tokens=9, token=CancelToken())
        assert next(answer) == "go "
        with pytest.raises(Unreachable, match="broke"):
            next(answer)
        assert len(server.asked) == 1


@pytest.mark.parametrize(
    "garbage",
    [
        "<html>502</html>",
        "data: {\n\n",
        "data: []\n\n",
        "data: 7\n\n",
        'data: {"choices": [7]}\n\n',
        'data: {"choices": {}, "x": 1}\n\ndata: "\ud83e"\n\n',
        f"data: {'[' * 100_000}\n\n",
        b"\xff\xfe\x00data: \x80\n\n",
        b"x" * (1 << 19),
    ],
    ids=range(9),
)
def test_garbage_is_an_error_never_a_crash(garbage: str | bytes) -> None:
    def send(reply: Reply) -> None:
        reply.stream()
        reply.raw(garbage if isinstance(garbage, bytes) else garbage.encode("utf-8", "replace"))

    with serving(send) as server, pytest.raises(ServerFailed):
        ask(server.model())


def test_a_reply_without_end_is_cut_off() -> None:
    def flood(reply: Reply) -> None:
        reply.stream()
        while True:
            reply.raw(": nothing\n" * 10_000)

    with serving(flood) as server, pytest.raises(Unusable, match="MiB"):
        ask(server.model())
    assert server.gone.wait(HUNG_S)
    assert len(server.asked) == 1


def test_an_error_within_the_stream_is_told() -> None:
    def fail(reply: Reply) -> None:
        reply.stream()
        reply.raw('data: {"error": {"message": "out of\\nmemory"}}\n\n')

    with serving(fail) as server, pytest.raises(Unreachable, match="out of memory"):
        ask(server.model())


@pytest.mark.parametrize("models", ["{}", "[]", "no json", '{"data": []}', '{"data": [7]}'])
def test_a_list_of_models_that_is_none_is_an_error(models: str) -> None:
    with serving(GOOD) as server:
        server.models = models
        with pytest.raises(Unusable):
            ask(server.model())
