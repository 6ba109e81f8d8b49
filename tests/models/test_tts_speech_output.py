"""Speech output with real voices, in simulated time: nobody waits for the speech to be over."""

import threading
from collections.abc import Iterator

import numpy as np
import pytest
from guards import HUNG_S
from voice_engines import hear, voice, words, wrong_words

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import Chunk, Samples
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.sinks.paced import PacedSink
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.tts.voices import VoicePool

pytestmark = pytest.mark.long

KITCHEN = "The robot drives to the kitchen and picks up the red cup."
BACK = "After that it drives back to the door."


class Room:
    """A loudspeaker and a clock: time passes only while somebody waits for the sound."""

    name = "room"
    rate_hz = 16_000
    block_s = 0.02
    lead_s = 0.0

    def __init__(self) -> None:
        self.now_s = 0.0
        self.heard: list[Samples] = []
        self.cut_at_s = float("inf")
        self.hold = threading.Event()
        self.hold.set()

    def now(self) -> float:
        return self.now_s

    def wait(self, token: CancelToken, seconds: float) -> bool:
        assert self.hold.wait(HUNG_S), "what the loudspeaker waits for did not happen"
        self.now_s += seconds
        if self.now_s >= self.cut_at_s:
            token.cancel("enough")
        return token.cancelled

    def write(self, samples: Samples, start_s: float) -> None:
        self.heard.append(samples)

    def close(self) -> None: ...

    def recording(self) -> list[Chunk]:
        return [Chunk(np.concatenate(self.heard), self.rate_hz)]


@pytest.fixture
def room() -> Room:
    return Room()


@pytest.fixture(scope="module")
def pool() -> VoicePool:
    return VoicePool()


@pytest.fixture(params=["en_US-joe-medium", "espeak-en"])
def synthesiser(request: pytest.FixtureRequest, room: Room, pool: VoicePool) -> SentenceSynthesiser:
    choice = voice("en", request.param)
    return SentenceSynthesiser(lambda: [choice], pool, clock=room)


@pytest.fixture
def speech_output(room: Room, synthesiser: SentenceSynthesiser) -> Iterator[SpeechOutput]:
    speech_output = SpeechOutput(
        synthesiser, PacedSink(room, clock=room, wait=room.wait), clock=room
    )
    speech_output.start()
    yield speech_output
    speech_output.close()


def test_what_was_said_is_what_a_person_in_the_room_hears(room: Room, speech_output: SpeechOutput):
    utterance = speech_output.begin(CancelToken(), lambda: None)
    utterance.say(KITCHEN)
    utterance.say(BACK)
    spoken = utterance.finish()
    assert spoken.text == f"{KITCHEN} {BACK}"
    assert wrong_words(words(spoken.text), hear(room.recording(), "en")) <= 3  # of 20


def test_what_is_remembered_of_a_cut_sentence_is_what_was_heard_of_it(
    room: Room, speech_output: SpeechOutput
):
    token = CancelToken()
    room.cut_at_s = 1.8
    utterance = speech_output.begin(token, lambda: None)
    utterance.say(KITCHEN)
    spoken = utterance.finish()
    assert spoken.cut
    assert room.now_s - room.cut_at_s <= 0.1
    seconds = sum(len(samples) for samples in room.heard) / room.rate_hz
    assert seconds <= room.cut_at_s + 0.1
    heard, remembered = hear(room.recording(), "en"), words(spoken.text)
    assert words(KITCHEN)[: len(remembered)] == remembered
    assert abs(len(remembered) - len(heard)) <= 2


def test_the_next_sentence_is_synthesised_before_the_loudspeaker_has_played_any(
    room: Room, speech_output: SpeechOutput, synthesiser: SentenceSynthesiser
):
    room.hold.clear()
    utterance = speech_output.begin(CancelToken(), lambda: None)
    utterance.say(KITCHEN)
    utterance.say(BACK)
    assert speech_output.prepare().wait(HUNG_S), "the synthesis waits for the loudspeaker"
    assert room.now_s == 0.0
    room.hold.set()
    assert utterance.finish().text == f"{KITCHEN} {BACK}"
