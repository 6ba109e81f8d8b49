"""Speech with a server: its voice speaks first, and one on board the rest of what it cannot say."""

import threading
from collections.abc import Iterator

import numpy as np
import pytest
from guards import HUNG_S
from support.clock import HeldClock
from waiting import wait_until

from edgevox.core.cancel import CancelToken
from edgevox.core.languages import Voice
from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import LOOK_S, ServerFailed, Unreachable
from edgevox.core.servers.health import FIRST_REST_S, Breaker
from edgevox.voice.audio import Chunk
from edgevox.voice.remote.shared_speech import SharedSpeech
from edgevox.voice.remote.speaking import NoVoice
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.spoken_answer import SpeakingUtterance
from edgevox.voice.tts.voices import VoiceChoice, VoicePool

LONG = "One two three four five six seven eight nine ten, " * 4


class Server:
    address = Address("tcp://speech:10200", setting="tts_endpoint")

    def __init__(self) -> None:
        self.fails_at: int | None = None
        self.error: ServerFailed = Unreachable("refused")
        self.said: list[tuple[str, str]] = []
        self.alive = True
        self.may_speak = threading.Event()
        self.may_speak.set()

    def speak(self, text: str, language: str, token: CancelToken) -> Iterator[Chunk]:
        if self.fails_at == len(self.said):
            raise self.error
        assert self.may_speak.wait(HUNG_S)
        self.said.append((text, language))
        yield Chunk(np.ones(240, np.int16), 24_000)

    def look(self, language: str, token: CancelToken) -> None:
        if self.fails_at == len(self.said):
            raise self.error

    def lives(self, token: CancelToken) -> bool:
        return self.alive

    def close(self) -> None: ...


class Pool:
    """On board, a voice that makes 160 samples of each phrase."""

    def __init__(self) -> None:
        self.loaded: list[str] = []
        self.said: list[str] = []

    def get(self, choice: VoiceChoice):
        self.loaded.append(choice.name)
        return self

    sample_rate_hz, phrase_chars = 16_000, 90

    def synthesise(self, text: str, token: CancelToken) -> Iterator[Chunk]:
        self.said.append(text)
        yield Chunk(np.ones(160, np.int16), 16_000)


class Rig:
    def __init__(self) -> None:
        self.server, self.clock, self.on_board = Server(), HeldClock(0.0), Pool()
        self.language = "en"
        self.shared = SharedSpeech(
            self.server,
            lambda: (VoiceChoice(self.language, Voice("amy", "piper", "amy")),),
            lambda: self.language,
            breaker=Breaker(self.clock),
        )
        pool = VoicePool(server=self.shared.open)
        outer = self

        class Both:
            def get(self, choice: VoiceChoice):
                return (pool if choice.backend == "server" else outer.on_board).get(choice)

        self.synthesiser = SentenceSynthesiser(self.shared, Both())

    def say(self, text: str) -> list[int]:
        """The rates of its chunks."""
        utterance = SpeakingUtterance(CancelToken(), lambda: None, lambda *_: None, lambda _: None)
        line = utterance.log.begin(text)
        return [one.rate_hz for one in self.synthesiser.speak(utterance, line, text)]


@pytest.fixture
def rig() -> Iterator[Rig]:
    rig = Rig()
    yield rig
    rig.server.may_speak.set()
    rig.shared.close()


def test_the_server_speaks_in_the_language(rig: Rig) -> None:
    assert rig.say("Hello.") == [24_000]
    assert rig.server.said == [("Hello.", "en")]
    assert rig.on_board.said == []


def test_a_server_that_fails_in_a_sentence_leaves_the_rest_to_a_voice_on_board(rig: Rig) -> None:
    rig.server.fails_at = 1
    rates = rig.say(LONG)
    said = "".join([rig.server.said[0][0], *rig.on_board.said]).replace(" ", "")
    assert rates[0] == 24_000
    assert set(rates[1:]) == {16_000}
    assert said == LONG.replace(" ", "")
    assert rig.synthesiser.fault == ""


def test_a_server_that_is_down_is_left_alone_and_asked_again_later(rig: Rig) -> None:
    rig.server.fails_at = 0
    assert [rig.say("Hello.") for _ in range(3)] == [[16_000]] * 3
    assert rig.shared.health.figures() == {"server_up": False, "fallbacks": 3, "turned_away": 0}
    rig.server.fails_at = None
    assert rig.say("Hello.") == [16_000]
    assert rig.server.said == []


def test_nobody_waits_for_a_server_that_failed_last_to_be_tried_again(rig: Rig) -> None:
    rig.server.fails_at = 0
    rig.say("Hello.")
    rig.server.fails_at = None
    rig.clock.advance(FIRST_REST_S)
    rig.server.may_speak.clear()
    assert [rig.say("Hello.") for _ in range(2)] == [[16_000]] * 2
    rig.server.may_speak.set()
    wait_until(lambda: not rig.shared.health.fault)
    assert rig.say("Hello.") == [24_000]
    assert len(rig.server.said) == 2


def test_nobody_waits_for_a_server_that_hangs(rig: Rig) -> None:
    def hangs(text: str, language: str, token: CancelToken) -> Iterator[Chunk]:
        token.wait(HUNG_S)
        yield from ()

    rig.server.speak, rig.server.alive = hangs, False
    assert rig.say("Hello.") == [16_000]
    assert "no sign of life" in rig.shared.health.fault


def test_a_server_that_shows_no_life_while_it_speaks_is_waited_for_once_that_is_known(
    rig: Rig,
) -> None:
    speaks = rig.server.speak

    def slowly(text: str, language: str, token: CancelToken) -> Iterator[Chunk]:
        if not token.wait(3 * LOOK_S):
            yield from speaks(text, language, token)

    rig.server.speak, rig.server.alive = slowly, False
    assert rig.say("Hello.") == [16_000]
    rig.clock.advance(FIRST_REST_S)
    assert rig.say("Hello.") == [16_000]  # and the server is asked in the background
    wait_until(lambda: not rig.shared.health.fault)
    assert rig.say("Hello.") == [24_000]


def test_a_language_that_the_server_has_no_voice_for_is_spoken_on_board(rig: Rig) -> None:
    rig.language, rig.server.fails_at = "de", 0
    rig.server.error = NoVoice("speech", "de")
    assert rig.say("Hallo.") == [16_000]
    rig.server.fails_at = None
    assert rig.say("Hallo.") == [16_000]
    rig.language = "en"
    assert rig.say("Hello.") == [24_000]
    assert not rig.shared.health.resting


def test_a_voice_on_board_is_loaded_behind_the_servers(rig: Rig) -> None:
    rig.synthesiser.prepare()
    assert rig.on_board.loaded == ["amy"]
    assert rig.synthesiser.last is not None
    assert rig.synthesiser.last[0].backend == "server"
