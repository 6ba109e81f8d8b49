"""A model on a server: how it is asked, with which key, and what comes through."""

import logging
import threading
from pathlib import Path

import pytest
from llm_server import CHAT, GOOD, ROOMS, Reply, ask, serving

from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import Unusable
from edgevox.core.settings import GrammarDialect


def test_an_answer_comes_in_pieces() -> None:
    with serving(GOOD) as server:
        answer = server.model().generate(CHAT, grammar=ROOMS, max_tokens=9, token=CancelToken())
        assert list(answer) == ["go ", "kit", "chen!"]


def test_the_first_piece_is_there_before_the_second_is_sent() -> None:
    first_heard = threading.Event()

    def slowly(reply: Reply) -> None:
        reply.stream()
        reply.piece("go ")
        assert first_heard.wait(60)
        reply.piece("kitchen!", "stop")

    with serving(slowly) as server:
        answer = server.model().generate(CHAT, grammar=ROOMS, max_tokens=9, token=CancelToken())
        assert next(answer) == "go "
        first_heard.set()
        assert list(answer) == ["kitchen!"]


def test_the_server_is_asked_greedily_for_the_model_that_it_has() -> None:
    with serving(GOOD) as server:
        ask(server.model())
    assert server.routes == ["/v1/models", "/v1/chat/completions"]
    asked = server.asked[0]
    assert (asked["model"], asked["temperature"], asked["stream"]) == ("tiny", 0.0, True)
    assert asked["messages"] == [{"role": m.role, "content": m.content} for m in CHAT]
    assert asked["max_tokens"] == 9


def test_a_server_is_asked_what_it_is_only_once() -> None:
    with serving(GOOD) as server:
        model = server.model()
        assert ask(model) == ask(model) == "go kitchen!"
    assert server.routes.count("/v1/models") == 1


@pytest.mark.parametrize(
    ("owner", "dialect", "field", "value"),
    [
        ("llamacpp", "auto", "grammar", ROOMS),
        ("vllm", "auto", "structured_outputs", {"grammar": ROOMS}),
        ("somebody", "vllm-guided", "guided_grammar", ROOMS),
        ("vllm", "llama-server", "grammar", ROOMS),
    ],
)
def test_each_kind_of_server_gets_the_grammar_its_own_way(
    owner: str, dialect: GrammarDialect, field: str, value: object
) -> None:
    with serving(GOOD, owner=owner) as server:
        ask(server.model(dialect=dialect))
    grammars = {"grammar", "structured_outputs", "guided_grammar"} & server.asked[0].keys()
    assert grammars == {field}
    assert server.asked[0][field] == value


def test_a_server_that_knows_no_grammar_is_sent_none_and_may_obey_all_the_same() -> None:
    with serving(GOOD, owner="openai") as server:
        assert ask(server.model()) == "go kitchen!"
    assert "grammar" not in server.asked[0]


def test_with_model_and_grammar_named_the_server_is_not_asked_what_it_is() -> None:
    with serving(GOOD) as server:
        assert ask(server.model(model="big", dialect="none")) == "go kitchen!"
    assert server.routes == ["/v1/chat/completions"]
    assert server.asked[0]["model"] == "big"


def test_an_address_that_ends_in_v1_is_taken_as_it_is() -> None:
    for url in ("http://llm:8080", "http://llm:8080/", "http://llm:8080/v1", "http://llm:8080/v1/"):
        assert Address(url).route("models") == "http://llm:8080/v1/models"
    assert Address("https://a.example/llm").route("models") == "https://a.example/llm/v1/models"


def test_the_key_is_read_anew_for_each_request_and_never_logged(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "key"
    with serving(GOOD) as server, caplog.at_level(logging.DEBUG):
        model = server.model(key_file=file)
        file.write_text("hunter-one\n")
        ask(model)
        file.write_text("hunter-two\n")
        ask(model)
    assert server.keys == ["Bearer hunter-one", "Bearer hunter-two"]
    assert "hunter" not in caplog.text
    assert "hunter" not in repr(Address(server.url, key_file=file))


@pytest.mark.parametrize("content", [None, "", "two words", "clé", "a\nb"])
def test_a_key_file_that_holds_no_key_is_named_without_its_content(
    tmp_path: Path, content: str | None
) -> None:
    file = tmp_path / "key"
    if content is not None:
        file.write_text(content)
    with serving(GOOD) as server, pytest.raises(Unusable, match="llm_endpoint_key_file") as caught:
        ask(server.model(key_file=file))
    assert not content or content not in str(caught.value).replace(str(file), "")


def test_a_redirect_does_not_carry_the_key_elsewhere(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_text("hunter")
    with serving(GOOD) as thief:
        away = f"{thief.url}/v1/chat/completions"
        moved = serving(lambda r: r.status(307, Location=away))
        with moved as server, pytest.raises(Unusable, match="307"):
            ask(server.model(key_file=file))
    assert thief.routes == []


def test_the_proxy_of_the_environment_is_not_used(monkeypatch) -> None:
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    with serving(GOOD) as server:
        assert ask(server.model()) == "go kitchen!"
