"""The model on board answers while the server cannot, and the server again when it can."""

import logging
from collections.abc import Iterator, Sequence

import pytest
from guards import HUNG_S
from llm_server import Chat, Server, failing, good, never, serving
from support.clock import HeldClock

from edgevox.agent.llm.language_model import ChatMessage, ModelBusy, ModelFailed
from edgevox.agent.llm.remote_model import EndpointModel, FallbackModel
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import Unreachable
from edgevox.core.servers.health import FIRST_REST_S, LONGEST_REST_S, Breaker

CHAT = [ChatMessage("user", "Who are you?")]


class OnBoard:
    name, context_tokens = "on board", 2048

    def __init__(self) -> None:
        self.primed: list[Sequence[ChatMessage]] = []
        self.closed = False

    def generate(self, messages, *, grammar, max_tokens, token) -> Iterator[str]:
        yield "on board"

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        self.primed.append(messages)

    def count_tokens(self, text: str) -> int:
        return 1000 * len(text)

    def close(self) -> None:
        self.closed = True


class Rig:
    def __init__(self, server: Server, on_board: OnBoard | None, timeout_s: float) -> None:
        self.clock = HeldClock(1000.0)
        self.shared = EndpointModel(Address(server.url, timeout_s=timeout_s), context_tokens=4096)
        self.model = FallbackModel(self.shared, on_board, Breaker(self.clock))

    def ask(self) -> str:
        return "".join(self.model.generate(CHAT, grammar=None, max_tokens=9, token=CancelToken()))


@pytest.fixture
def rig(request: pytest.FixtureRequest):
    def make(
        *chats: Chat, on_board: OnBoard | None, timeout_s: float = HUNG_S
    ) -> tuple[Rig, Server]:
        running = serving(*chats)
        server = running.__enter__()
        request.addfinalizer(lambda: running.__exit__(None, None, None))
        one = Rig(server, on_board, timeout_s)
        request.addfinalizer(one.model.close)
        return one, server

    return make


def warnings(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [r.message for r in caplog.records if r.levelno >= logging.WARNING]


def test_a_server_that_works_is_the_one_that_answers(rig, caplog) -> None:
    one, _ = rig(good("shared"), on_board=OnBoard())

    assert one.ask() == "shared"
    assert warnings(caplog) == []


@pytest.mark.parametrize("chat", [never, failing(500), failing(401), failing(404)])
def test_a_server_that_fails_is_replaced_and_then_left_alone(rig, caplog, chat: Chat) -> None:
    one, server = rig(chat, on_board=OnBoard(), timeout_s=3.0 if chat is never else HUNG_S)

    assert one.ask() == "on board"
    tried = len(server.asked)
    assert [one.ask() for _ in range(3)] == ["on board"] * 3

    assert len(server.asked) == tried
    (said,) = warnings(caplog)
    assert said.startswith("model_server_failed")
    assert "instead='the model on board'" in said


def test_after_a_rest_it_is_tried_again_and_said_to_be_back(rig, caplog) -> None:
    one, _ = rig(failing(401), good("shared"), on_board=OnBoard())
    assert one.ask() == "on board"

    one.clock.now_s += FIRST_REST_S

    assert one.ask() == one.ask() == "shared"
    events = [said.partition(" ")[0] for said in warnings(caplog)]
    assert events == ["model_server_failed", "model_server_back"]


def test_a_server_that_goes_on_failing_is_mentioned_once(rig, caplog) -> None:
    one, server = rig(failing(401), on_board=OnBoard())

    for _ in range(5):
        assert one.ask() == "on board"
        one.clock.now_s += LONGEST_REST_S

    assert len(server.asked) == 5
    assert len(warnings(caplog)) == 1


def test_a_request_that_is_refused_goes_on_board_and_the_next_to_the_server(rig) -> None:
    one, _ = rig(failing(400, "too long"), good("shared"), on_board=OnBoard())

    assert [one.ask(), one.ask()] == ["on board", "shared"]


def test_a_full_server_is_asked_again_by_the_next_question_and_mentioned_once(rig, caplog) -> None:
    full = failing(429)
    one, server = rig(full, full, good("shared"), full, on_board=OnBoard())

    assert [one.ask() for _ in range(4)] == ["on board", "on board", "shared", "on board"]

    assert len(server.asked) == 4
    assert (one.model.health.turned_away, one.model.health.fallbacks, one.model.fault) == (3, 3, "")
    events = [said.partition(" ")[0] for said in warnings(caplog)]
    assert events == ["model_server_full"] * 2


def test_without_a_model_on_board_a_full_server_is_told_apart_from_one_that_failed(rig) -> None:
    one, _ = rig(failing(429), good("shared"), on_board=None)

    with pytest.raises(ModelBusy):
        one.ask()
    assert one.ask() == "shared"


def test_an_answer_that_has_begun_is_not_begun_again_by_the_other(rig) -> None:
    one, _ = rig(lambda r: (r.stream(), r.piece("shar")), on_board=OnBoard())
    answer = one.model.generate(CHAT, grammar=None, max_tokens=9, token=CancelToken())

    assert next(answer) == "shar"
    with pytest.raises(ModelFailed):
        next(answer)
    assert one.ask() == "on board"


def test_a_cancelled_request_is_not_answered_by_the_other(rig) -> None:
    token = CancelToken()
    one, _ = rig(lambda r: token.cancel(), on_board=OnBoard())

    assert list(one.model.generate(CHAT, grammar=None, max_tokens=9, token=token)) == []


def test_without_a_model_on_board_the_failure_is_told_at_once_while_it_lasts(rig) -> None:
    one, server = rig(failing(401), on_board=None)

    for _ in range(2):
        with pytest.raises(ModelFailed):
            one.ask()
    assert len(server.asked) == 1


def test_both_are_primed_even_if_one_fails(rig) -> None:
    on_board = OnBoard()
    one, server = rig(failing(401), on_board=on_board)

    one.model.prime(CHAT, CancelToken())

    assert on_board.primed == [CHAT]
    assert server.asked[0]["max_tokens"] == 1


def test_the_smaller_context_and_the_larger_count_are_what_counts(rig) -> None:
    one, _ = rig(good("shared"), on_board=OnBoard())

    assert one.model.context_tokens == 2048
    assert one.model.count_tokens("abc") == 3000


def test_closing_closes_both(rig) -> None:
    on_board = OnBoard()
    one, _ = rig(good("shared"), on_board=on_board)

    one.model.close()

    assert on_board.closed
    with pytest.raises(Unreachable, match="closed"):
        list(one.shared.generate(CHAT, grammar=None, max_tokens=9, token=CancelToken()))


def test_the_rest_doubles_up_to_a_limit_and_one_success_ends_it() -> None:
    clock = HeldClock(1000.0)
    breaker = Breaker(clock)
    rests = []
    for _ in range(7):
        breaker.failed()
        begun_s = clock.now()
        while breaker.resting:
            clock.now_s += 1
        rests.append(clock.now() - begun_s)

    assert rests[:3] == [FIRST_REST_S, 2 * FIRST_REST_S, 4 * FIRST_REST_S]
    assert rests[-1] == LONGEST_REST_S
    assert breaker.succeeded()
    assert not breaker.succeeded()
    assert breaker.failed()
