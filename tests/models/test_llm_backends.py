"""What every engine promises, asked of each with the same small model."""

import itertools
import os
import socket
import stat
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest

from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import ChatMessage, LanguageModel, ModelFailed
from edgevox.agent.llm.llama_cpp_model import LlamaCppModel
from edgevox.agent.llm.xllamacpp_model import XllamacppModel, post
from edgevox.core.cancel import CancelToken
from edgevox.core.settings import LlmBackend

pytestmark = pytest.mark.long

BACKENDS: tuple[LlmBackend, ...] = ("xllamacpp", "llama-cpp-python")
STORY = [ChatMessage("user", "Tell me a long story about a robot in a kitchen.")]
SPUN_S = 0.5
ROOMS = 'root ::= "go " ("kitchen" | "bedroom") "!"'


def ask(
    model: LanguageModel,
    messages: list[ChatMessage],
    *,
    grammar: str | None = None,
    max_tokens: int = 24,
    token: CancelToken | None = None,
) -> list[str]:
    answer = model.generate(
        messages, grammar=grammar, max_tokens=max_tokens, token=token or CancelToken()
    )
    return list(answer)


def timed(action: Callable[[], object]) -> float:
    """Seconds that it computed, whatever else the machine does meanwhile."""
    begun = time.process_time()
    action()
    return time.process_time() - begun


def computed_beside(seconds: float) -> float:
    """Seconds that all other threads computed while this one did for so long, on any machine.

    One that spins gets as much of a core as this one, however fast and however busy that is.
    """
    own_s, whole_s = time.thread_time(), time.process_time()
    while (spun_s := time.thread_time() - own_s) < seconds:
        pass
    return time.process_time() - whole_s - spun_s


def long_prompt(words: int, start: str) -> list[ChatMessage]:
    return [ChatMessage("system", start + " kind" * words), ChatMessage("user", "Hello")]


def first_piece_s(model: LanguageModel, messages: list[ChatMessage]) -> float:
    return timed(lambda: ask(model, messages, grammar='root ::= "a"', max_tokens=1))


@pytest.fixture(scope="module")
def whole_s(model: LanguageModel) -> float:
    """How long a long answer takes."""
    return timed(lambda: ask(model, STORY, max_tokens=100))


def test_an_answer_arrives_in_pieces(model: LanguageModel) -> None:
    pieces = ask(model, STORY)

    assert len(pieces) > 10
    assert all(pieces)


def test_the_same_chat_gives_the_same_answer(model: LanguageModel) -> None:
    assert "".join(ask(model, STORY)) == "".join(ask(model, STORY))


def test_the_grammar_is_obeyed(model: LanguageModel) -> None:
    assert "".join(ask(model, STORY, grammar=ROOMS)) in {"go kitchen!", "go bedroom!"}


def test_no_more_than_max_tokens_are_decoded(model: LanguageModel) -> None:
    text = "".join(ask(model, STORY, max_tokens=5))

    assert 1 <= model.count_tokens(text) <= 6


def test_a_cancelled_answer_ends_within_one_piece(model: LanguageModel) -> None:
    token = CancelToken()
    answer = model.generate(STORY, grammar=None, max_tokens=400, token=token)

    heard = list(itertools.islice(answer, 5))
    token.cancel()
    after = list(answer)

    assert len(heard) == 5
    assert len(after) <= 1


def test_a_cancelled_answer_frees_the_engine_at_once(model: LanguageModel, whole_s: float) -> None:
    token = CancelToken()
    answer = model.generate(STORY, grammar=None, max_tokens=100, token=token)
    next(answer)

    token.cancel()
    list(answer)
    next_s = timed(lambda: ask(model, STORY, max_tokens=1))

    assert next_s < whole_s / 4


def test_a_prompt_that_is_being_read_can_be_cancelled(model: LanguageModel) -> None:
    whole_s = timed(lambda: ask(model, long_prompt(400, "Be"), max_tokens=1))
    token = CancelToken()
    timer = threading.Timer(whole_s / 10, token.cancel)
    timer.start()

    cut_s = timed(lambda: ask(model, long_prompt(400, "Stay"), max_tokens=1, token=token))
    next_s = timed(lambda: ask(model, STORY, max_tokens=1))
    timer.join()

    assert token.cancelled
    assert cut_s + next_s < whole_s / 2


def test_a_token_that_is_already_cancelled_gives_nothing(model: LanguageModel) -> None:
    token = CancelToken()
    token.cancel()

    assert ask(model, STORY, token=token) == []


def test_an_answer_that_nobody_listens_to_is_dropped(model: LanguageModel, whole_s: float) -> None:
    answer = model.generate(STORY, grammar=None, max_tokens=100, token=CancelToken())
    next(answer)

    answer.close()  # type: ignore[attr-defined]
    next_s = timed(lambda: ask(model, STORY, max_tokens=1))

    assert next_s < whole_s / 4


def test_what_was_primed_is_not_read_again(model: LanguageModel) -> None:
    cold_s = first_piece_s(model, long_prompt(200, "Always be"))
    model.prime(long_prompt(200, "Never be"), CancelToken())

    warm_s = first_piece_s(model, [*long_prompt(200, "Never be")[:1], ChatMessage("user", "Who?")])

    assert warm_s < cold_s / 3


def test_a_grammar_that_does_not_parse_is_refused(model: LanguageModel) -> None:
    with pytest.raises(ModelFailed, match="grammar"):
        ask(model, STORY, grammar='root ::= "go')


def test_a_refused_request_leaves_the_model_usable(model: LanguageModel) -> None:
    with pytest.raises(ModelFailed):
        ask(model, STORY, grammar="root ::= nothing")

    assert ask(model, STORY)


def test_a_chat_longer_than_the_context_is_refused(model: LanguageModel) -> None:
    with pytest.raises(ModelFailed, match="exceeds"):
        ask(model, long_prompt(600, "Be"))


def test_an_answer_that_fills_the_context_ends_there(model: LanguageModel) -> None:
    messages = long_prompt(440, "Be")

    assert len(ask(model, messages, grammar='root ::= "a"*', max_tokens=400)) < 100


def test_tokens_are_counted(model: LanguageModel) -> None:
    assert model.count_tokens("") == 0
    assert 3 <= model.count_tokens("go to the kitchen") <= 6
    assert model.count_tokens("go to the kitchen " * 10) > 30


def test_text_outside_ascii_comes_back_whole(model: LanguageModel) -> None:
    wanted = "Zürich 🤖 東京"

    assert "".join(ask(model, STORY, grammar=f'root ::= "{wanted}"', max_tokens=60)) == wanted


def test_two_threads_are_served_one_after_the_other(model: LanguageModel) -> None:
    expected = "".join(ask(model, STORY))
    answers: list[str] = []
    threads = [
        threading.Thread(target=lambda: answers.append("".join(ask(model, STORY))))
        for _ in range(2)
    ]

    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert answers == [expected, expected]


@pytest.mark.parametrize("backend", BACKENDS)
def test_closing_ends_an_answer_and_every_thread(backend: LlmBackend, tiny_path: Path) -> None:
    before = {thread.name for thread in threading.enumerate()}
    model = load_model(tiny_path, backend, context_tokens=512)
    answer = model.generate(STORY, grammar=None, max_tokens=400, token=CancelToken())
    next(answer)
    closer = threading.Thread(target=model.close)
    closer.start()

    with pytest.raises(ModelFailed, match="closed"):
        list(answer)
    closer.join()

    assert {thread.name for thread in threading.enumerate()} <= before
    with pytest.raises(ModelFailed, match="closed"):
        ask(model, STORY)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_loaded_model_that_is_not_asked_anything_does_not_spin(
    backend: LlmBackend, tiny_path: Path
) -> None:
    model = load_model(tiny_path, backend, context_tokens=512)
    ask(model, STORY, max_tokens=4)
    CancelToken().wait(0.2)

    beside_s = computed_beside(SPUN_S)
    model.close()

    assert beside_s < SPUN_S / 20


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_truncated_model_is_refused(backend: LlmBackend, tiny_path: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.gguf"
    with tiny_path.open("rb") as whole:
        cut.write_bytes(whole.read(4_000_000))

    with pytest.raises(ModelFailed, match="truncated"):
        load_model(cut, backend)


@pytest.mark.parametrize("driver", [XllamacppModel, LlamaCppModel])
def test_an_engine_that_cannot_load_a_file_says_which(
    driver: type[XllamacppModel] | type[LlamaCppModel], tmp_path: Path
) -> None:
    path = tmp_path / "noise.gguf"
    path.write_bytes(b"GGUF" + bytes(1000))

    with pytest.raises(ModelFailed, match=r"noise\.gguf"):
        driver(path)


@pytest.fixture
def temporary(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where a model puts its socket, whose whole path may have a hundred characters."""
    with tempfile.TemporaryDirectory() as folder:
        monkeypatch.setattr(tempfile, "tempdir", folder)
        yield Path(folder)


@pytest.fixture
def listening(temporary: Path, tiny_path: Path) -> Iterator[Path]:
    """The socket of a model that was just loaded."""
    with closing(XllamacppModel(tiny_path, context_tokens=256)):
        (path,) = temporary.glob("*/*.sock")
        yield path


def listeners() -> set[str]:
    """The network sockets of this process that take connections."""
    mine = {os.readlink(one) for one in Path("/proc/self/fd").iterdir() if one.is_symlink()}
    lines = [
        line.split()
        for table in ("tcp", "tcp6")
        for line in Path("/proc/self/net", table).read_text("ascii").splitlines()[1:]
    ]
    return {one[1] for one in lines if one[3] == "0A" and f"socket:[{one[9]}]" in mine}


def test_the_engine_listens_on_no_network_and_only_for_this_user(
    temporary: Path, tiny_path: Path
) -> None:
    before = listeners()
    with closing(XllamacppModel(tiny_path, context_tokens=256)):
        (path,) = temporary.glob("*/*.sock")

        assert listeners() == before
        assert stat.S_IMODE(path.parent.stat().st_mode) == stat.S_IRWXU
        assert stat.S_ISSOCK(path.stat().st_mode)


def test_the_socket_refuses_a_request_without_the_key(listening: Path) -> None:
    chat = {"messages": [{"role": "user", "content": "Hello"}], "max_tokens": 1}

    for route in ("/tokenize", "/v1/chat/completions"):
        with pytest.raises(ModelFailed, match="401"):
            post(listening, route, chat, "guessed")


def test_closing_removes_the_socket(temporary: Path, tiny_path: Path) -> None:
    model = XllamacppModel(tiny_path, context_tokens=256)
    (path,) = temporary.glob("*/*.sock")

    model.close()

    with pytest.raises(FileNotFoundError), socket.socket(socket.AF_UNIX) as client:
        client.connect(str(path))
    assert not path.parent.exists()
