"""Hearing with a server: stop words never wait for it, and it is left alone when down."""

import threading
from collections.abc import Callable

import numpy as np
import pytest
from guards import HUNG_S
from support.clock import HeldClock
from waiting import wait_until

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import LOOK_S, ServerBusy, Unreachable
from edgevox.core.servers.health import FIRST_REST_S, Breaker
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.remote.shared_hearing import STOP_S, SharedSpeechToText
from edgevox.voice.stt.speech_to_text import Transcript

SHORT = np.zeros(int(STOP_S * RATE_HZ), np.int16)
LONG = np.zeros(int(STOP_S * RATE_HZ) + 1, np.int16)


class Server:
    """Answers with `does`, which may wait for `token`."""

    address = Address("http://speech:8000", setting="stt_endpoint")

    def __init__(self, does: Callable[[CancelToken], Transcript]) -> None:
        self.does = does
        self.alive = True
        self.asked: list[tuple[int, str, str]] = []

    def transcribe(self, samples: Samples, language: str, prompt: str, token: CancelToken):
        self.asked.append((samples.size, language, prompt))
        return self.does(token)

    def lives(self, token: CancelToken) -> bool:
        return self.alive

    def close(self) -> None: ...


class OnBoard:
    def __init__(self, text: str) -> None:
        self.text = text
        self.heard: list[int] = []
        self.missing = False

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        self.heard.append(samples.size)
        if self.missing:
            raise EdgeVoxError("whisper-base is not here")
        return Transcript(self.text)

    def warm_up(self, language: str) -> None:
        self.transcribe(SHORT, language)

    def close(self) -> None: ...


def says(text: str):
    return lambda _: Transcript(text, 0.85)


def fails(error: Exception):
    def does(_: CancelToken) -> Transcript:
        raise error

    return does


def hangs(token: CancelToken) -> Transcript:
    token.wait(HUNG_S)
    return Transcript("")


@pytest.fixture
def rig():
    made = []

    def make(does, on_board: str = "on board") -> SharedSpeechToText:
        clock = HeldClock(0.0)
        server, here = Server(does), OnBoard(on_board)
        one = SharedSpeechToText(
            server, here, prompt_of=lambda code: f"prompt {code}", breaker=Breaker(clock)
        )
        one.is_stop = lambda text: text == "stop"
        one.server, one.here, one.clock = server, here, clock
        made.append(one)
        return one

    yield make
    for one in made:
        one.close()


def test_the_server_has_the_words_in_the_language_with_its_prompt(rig) -> None:
    one = rig(says("from afar"))
    assert one.transcribe(LONG, "de").text == "from afar"
    assert one.server.asked == [(LONG.size, "de", "prompt de")]


def test_what_is_short_is_also_heard_on_board_and_the_servers_words_count(rig) -> None:
    one = rig(says("from afar"))
    assert one.transcribe(SHORT, "en").text == "from afar"
    assert one.here.heard == [SHORT.size]


def test_a_stop_word_on_board_counts_though_the_server_hears_another_word(rig) -> None:
    assert rig(says("shop"), "stop").transcribe(SHORT, "en").text == "stop"


@pytest.mark.parametrize("sound", [SHORT, LONG], ids=["short", "long"])
def test_a_stop_word_does_not_wait_for_a_server_that_hangs(rig, sound: Samples) -> None:
    one = rig(hangs, "stop")
    assert one.transcribe(sound, "en").text == "stop"
    assert not one.health.fault


@pytest.mark.parametrize("sound", [SHORT, LONG], ids=["short", "long"])
def test_nobody_waits_for_a_server_that_hangs_and_its_late_answer_tells_that_it_is_back(
    rig, sound: Samples
) -> None:
    may_answer = threading.Event()

    def hangs_at_first(_: CancelToken) -> Transcript:
        assert may_answer.wait(HUNG_S)
        return Transcript("from afar")

    one = rig(hangs_at_first)
    one.server.alive = False
    assert [one.transcribe(sound, "en").text for _ in range(3)] == ["on board"] * 3
    assert len(one.server.asked) == 1
    assert one.health.fallbacks == 3
    may_answer.set()
    wait_until(lambda: one.transcribe(sound, "en").text == "from afar")


def test_a_server_that_shows_no_life_while_it_hears_is_waited_for_once_that_is_known(rig) -> None:
    def slowly(token: CancelToken) -> Transcript:
        token.wait(3 * LOOK_S)
        return Transcript("from afar")

    one = rig(slowly)
    one.server.alive = False
    wait_until(lambda: one.transcribe(LONG, "en").text == "from afar")
    assert one.transcribe(LONG, "en").text == "from afar"


@pytest.mark.parametrize("sound", [SHORT, LONG], ids=["short", "long"])
def test_a_server_that_is_slow_and_alive_has_the_words(rig, sound: Samples) -> None:
    may_answer = threading.Event()

    def slowly(_: CancelToken) -> Transcript:
        assert may_answer.wait(HUNG_S)
        return Transcript("from afar")

    one = rig(slowly)
    threading.Timer(2 * LOOK_S, may_answer.set).start()
    assert one.transcribe(sound, "en").text == "from afar"


@pytest.mark.parametrize("sound", [SHORT, LONG], ids=["short", "long"])
def test_what_is_on_board_answers_when_the_server_fails_and_while_it_is_left_alone(
    rig, sound: Samples, caplog: pytest.LogCaptureFixture
) -> None:
    one = rig(fails(Unreachable("refused")))
    assert [one.transcribe(sound, "en").text for _ in range(3)] == ["on board"] * 3
    assert len(one.server.asked) == 1
    assert one.health.figures() == {"server_up": False, "fallbacks": 3, "turned_away": 0}


@pytest.mark.parametrize("sound", [SHORT, LONG], ids=["short", "long"])
def test_nobody_waits_for_a_server_that_failed_last_to_be_tried_again(rig, sound: Samples) -> None:
    one = rig(fails(Unreachable("refused")))
    one.transcribe(sound, "en")
    one.clock.advance(FIRST_REST_S)
    may_answer = threading.Event()

    def slowly(_: CancelToken) -> Transcript:
        assert may_answer.wait(HUNG_S)
        return Transcript("back")

    one.server.does = slowly
    assert [one.transcribe(sound, "en").text for _ in range(2)] == ["on board"] * 2
    may_answer.set()
    wait_until(lambda: not one.health.fault)
    assert one.transcribe(sound, "en").text == "back"
    assert len(one.server.asked) == 3


def test_a_server_is_asked_each_time_where_nothing_hears_on_board(rig) -> None:
    one = rig(fails(Unreachable("refused")))
    one.here.missing = True
    with pytest.raises(EdgeVoxError, match="whisper-base"):
        one.transcribe(LONG, "en")
    one.server.does = says("back")
    assert one.transcribe(LONG, "en").text == "back"


def test_a_full_server_is_asked_again_by_the_next_utterance(rig) -> None:
    one = rig(fails(ServerBusy("429")))
    assert one.transcribe(LONG, "en").text == "on board"
    one.server.does = says("from afar")
    assert one.transcribe(LONG, "en").text == "from afar"
    assert one.health.turned_away == 1


def test_without_a_model_on_board_the_server_hears_and_it_is_told(rig) -> None:
    one = rig(says("from afar"))
    one.here.missing = True
    one.warm_up("en")
    assert one.transcribe(SHORT, "en").text == "from afar"
    assert one.on_board_fault == "whisper-base is not here"
    one.server.does = fails(Unreachable("refused"))
    with pytest.raises(EdgeVoxError, match="whisper-base"):
        one.transcribe(LONG, "en")


def test_closing_ends_a_request_that_hangs(rig) -> None:
    asked = threading.Event()

    def hang(token: CancelToken) -> Transcript:
        asked.set()
        return hangs(token)

    one = rig(hang)
    thread = threading.Thread(target=one.transcribe, args=(LONG, "en"))
    thread.start()
    assert asked.wait(HUNG_S)
    one.close()
    thread.join(HUNG_S)
    assert not thread.is_alive()
