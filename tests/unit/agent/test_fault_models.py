"""Models that are missing, cut short or too large, and servers that are gone: what is still done.

Nothing here needs a model: the files are missing, damaged, or made up for the test.
"""

import struct
import threading
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import phrases
import pytest
from gguf_files import small_gguf
from llm_server import Chat, Reply, failing, good, never, serving
from support.clock import HeldClock
from support.conversation import Eloquent
from waiting import Heard

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm import factory, weights
from edgevox.agent.llm.language_model import ModelFailed
from edgevox.agent.llm.protocol import SAY
from edgevox.agent.llm.remote_model import EndpointModel, FallbackModel
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.agent.queries import deafness
from edgevox.apps.robots import build_body
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.controls import Controls
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import Responded
from edgevox.core.servers.address import Address
from edgevox.core.servers.health import FIRST_REST_S, Breaker
from edgevox.core.settings import load_settings
from edgevox.core.status import Level
from edgevox.voice.stt.speech_to_text import TELL_EVERY_S, Transcript, WatchedSpeechToText
from edgevox.voice.tts.voices import PresentVoices

WISH = "why does ice float on water?"


def answers_of(bus: Bus) -> Heard[str]:
    heard = Heard[str]()
    bus.subscribe(Responded, lambda event: heard.add(event.text))
    return heard


@pytest.fixture
def agent(tmp_path):
    """A whole agent in this process: its parts, what it answers, what its llm says of itself."""
    with ExitStack() as stack:

        def start(llm: str):
            settings = load_settings({"text_mode": True, "llm": llm})
            body = build_body("robot-apartment", settings, 0.0)
            parts = build_parts(stack, settings, body)
            heard = answers_of(parts.bus)
            start_parts(stack, parts)
            return parts, heard, lambda: parts.components.statuses({"llm"})[0]

        yield start


def cut_gguf(folder: Path) -> str:
    path = folder / "cut.gguf"
    path.write_bytes(b"GGUF" + struct.pack("<IQQ", 3, 1, 0) + b"cut")
    return str(path)


@pytest.mark.parametrize(
    ("llm", "reason"),
    [
        (lambda folder: str(folder / "none.gguf"), "there is no such model file"),
        (cut_gguf, "truncated"),
        (lambda _: "qwen2.5-coder-0.5b-instruct", "get it with: edgevox-models fetch qwen"),
    ],
    ids=["missing", "cut short", "never fetched"],
)
def test_without_its_model_it_comes_up_says_so_and_obeys(agent, tmp_path, monkeypatch, llm, reason):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path / "models"))
    parts, heard, llm_says = agent(llm(tmp_path))

    heard.wait_for(lambda said: "my language model failed" in said)
    parts.conversation.submit(TextInput("where are you"))
    heard.wait_for(lambda said: phrases.stands(room="living_room") in said)
    since = len(heard.messages)
    parts.conversation.submit(TextInput(WISH))
    heard.wait_for(lambda said: "I cannot think right now" in said, since=since)

    said = llm_says()
    assert said.level is Level.ERROR
    assert reason in said.message
    assert reason in parts.health.ready().checks["llm"]
    assert parts.health.live().well


def test_a_model_id_that_nobody_knows_is_a_mistake_and_refused(agent):
    with pytest.raises(EdgeVoxError, match="expected one of"):
        agent("no-such-model")


def test_the_context_counts_as_memory_by_what_the_file_says(tmp_path, monkeypatch):
    small_file = small_gguf(tmp_path)
    assert weights.check(small_file).bytes_per_token == 2 * 2 * 24 * 2 * 64
    free = weights.needed_bytes(weights.Weights(small_file.stat().st_size, 12288), 4096)
    assert free == weights.BUFFERS_BYTES + small_file.stat().st_size + 4096 * 12288
    monkeypatch.setattr(weights, "read_memory", lambda: weights.Memory(free, free))

    with pytest.raises(ModelFailed, match="out of memory: a context of 4097 tokens needs"):
        factory.load_model(small_file, "xllamacpp", context_tokens=4097)


@pytest.fixture
def asking(request):
    """A conversation that thinks with a server."""

    def start(*chats: Chat, on_board=None):
        running = serving(*chats)
        server = running.__enter__()
        request.addfinalizer(lambda: running.__exit__(None, None, None))
        clock = HeldClock()
        shared = EndpointModel(Address(server.url, timeout_s=5.0))
        model = FallbackModel(shared, on_board, Breaker(clock))
        request.addfinalizer(model.close)
        bus = Bus()
        heard = answers_of(bus)
        one = Conversation([Agent("edgevox", "Be brief.")], bus, halt=lambda _: False, model=model)
        request.addfinalizer(one.close)
        one.start()
        return one, heard, model, clock

    return start


def breaks_off(reply) -> None:
    reply.stream()
    reply.piece(SAY + "Once upon a time there was a robot. It ")


@pytest.mark.parametrize("bad", [failing(503), never], ids=["fails", "hangs"])
def test_a_server_that_is_gone_is_spoken_of_and_heard_again_when_it_is_back(asking, bad):
    back = threading.Event()
    here = good(SAY + "Whales swim.")

    def chat(reply: Reply) -> None:
        return (here if back.is_set() else bad)(reply)

    one, heard, model, clock = asking(chat)

    one.submit(TextInput(WISH))
    heard.wait_for(lambda said: "I cannot think right now" in said)
    assert model.fault

    back.set()
    clock.now_s += FIRST_REST_S
    one.submit(TextInput(WISH))
    heard.wait_for(lambda said: "Whales swim." in said)
    assert model.fault == ""


def test_a_server_that_is_gone_is_not_noticed_by_who_is_answered_on_board(asking):
    one, heard, model, _ = asking(failing(503), on_board=Eloquent(f"{SAY}Whales think."))

    one.submit(TextInput(WISH))

    heard.wait_for(lambda said: "Whales think." in said)
    assert heard.messages == ["Whales think."]
    assert "503" in model.fault


def test_a_full_server_is_spoken_of_as_busy_and_has_not_failed(asking):
    one, heard, model, _ = asking(failing(429))

    one.submit(TextInput(WISH))

    heard.wait_for(lambda said: "the language model that we share is busy" in said)
    assert model.fault == ""


def test_an_answer_that_breaks_off_is_ended_with_the_reason(asking):
    one, heard, model, _ = asking(breaks_off, on_board=Eloquent(f"{SAY}Whales think."))

    one.submit(TextInput(WISH))

    heard.wait_for(lambda said: "my language model failed" in said)
    (said,) = heard.messages
    assert said.startswith("Once upon a time there was a robot.")
    assert model.fault


class Deaf:
    """Speech to text that fails as often as it is told."""

    def __init__(self) -> None:
        self.failing = True

    def transcribe(self, samples, language):
        if self.failing:
            raise MemoryError("std::bad_alloc")
        return Transcript("where are you")

    def warm_up(self, language): ...

    def close(self): ...


def test_who_speaks_while_no_speech_is_recognised_is_told_so_now_and_then_and_not_afterwards():
    clock, deaf, told = HeldClock(), Deaf(), []
    stt = WatchedSpeechToText(deaf, clock)
    stt.tell = lambda: told.append(clock.now())
    silence = np.zeros(16000, np.int16)

    for _ in range(3):
        with pytest.raises(MemoryError):
            stt.transcribe(silence, "en")
    clock.now_s += TELL_EVERY_S
    with pytest.raises(MemoryError):
        stt.transcribe(silence, "en")
    assert told == [0.0, TELL_EVERY_S]
    assert stt.fault == "std::bad_alloc"

    deaf.failing = False
    assert stt.transcribe(silence, "en").text == "where are you"
    assert stt.fault == ""


def test_a_language_that_cannot_be_heard_here_is_refused_and_the_old_one_stays(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    controls = Controls(Bus(), language="en", voices=lambda _: (), deafness=deafness)

    with pytest.raises(InvalidValue, match="whisper-base is not here: edgevox-models fetch world"):
        controls.change({"language": "fr"})

    assert controls.language == "en"


def test_a_voice_whose_files_go_away_goes_on_speaking_and_no_other_takes_over():
    here: dict[str, Path] = {"piper-en_US-joe-medium": Path("joe.onnx")}
    wanted = ["en", ""]
    voices = PresentVoices(lambda: (wanted[0], wanted[1]), lambda: here.get)
    (joe, *_) = voices()
    assert joe.backend == "piper"

    here.clear()

    assert voices()[0] == joe
    assert [one.backend for one in voices()[1:]] == ["espeak"]


def test_a_voice_that_was_never_here_is_replaced_by_the_best_one_that_is():
    voices = PresentVoices(lambda: ("en", "en_US-joe-medium"), lambda: lambda _: None)

    assert [one.backend for one in voices()] == ["espeak"]
