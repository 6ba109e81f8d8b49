"""What a robot that talks does while its language model, its voice or its hearing is not there yet.

The order of events says so, not a number of seconds: each test holds what is slow, and lets it go.
"""

import threading
from contextlib import ExitStack

import numpy as np
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, silence
from voice_rig import SLOWLY, VoiceRig

from edgevox.agent.grammar import SAY
from edgevox.apps import composition
from edgevox.core.agent_events import ToolCalled
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded
from edgevox.voice.stt.watched import WatchedSpeechToText

KITCHEN = ("navigate_to", {"room": "kitchen"})


class SlowReader:
    """A model that reads its prompt until the test lets it; chats wait for that."""

    name, context_tokens = "slow reader", 4096

    def __init__(self):
        self.reads, self.may_end = threading.Event(), threading.Event()

    def generate(self, messages, *, grammar, max_tokens, token):
        assert self.may_end.wait(HUNG_S)
        yield SAY
        yield "Bees make it of nectar. "

    def prime(self, messages, token):
        token.on_cancel(self.may_end.set)
        self.reads.set()
        assert self.may_end.wait(HUNG_S)

    def count_tokens(self, text):
        return len(text.split())

    def close(self):
        self.may_end.set()


@pytest.fixture
def reader():
    one = SlowReader()
    yield one
    one.may_end.set()


@pytest.fixture
def rig(tmp_path, monkeypatch, reader):
    made = VoiceRig(
        monkeypatch, tmp_path / "out.wav", robot="robot-apartment", model=reader, speed=SLOWLY
    )
    with made as started:
        yield started


def spoken(text):
    return np.concatenate([silence(0.5), loud(says_espeak(text, "en-us"), 0.08), silence(1.5)])


def test_commands_are_done_while_the_language_model_still_reads_its_prompt(rig, reader):
    assert reader.reads.wait(HUNG_S)

    rig.room.play(spoken("go to the kitchen"))
    rig.wait_for(ToolCalled)

    assert rig.calls() == [KITCHEN]
    rig.room.play(spoken("stop"))
    rig.wait_for(Responded, lambda one: one.text.startswith("Stopped"))
    assert not reader.may_end.is_set()


def test_what_needs_the_model_meanwhile_is_answered_once_it_has_read(rig, reader):
    assert reader.reads.wait(HUNG_S)
    rig.parts.conversation.submit(TextInput("how do bees make honey"))
    assert not rig.of(Responded)

    reader.may_end.set()

    rig.wait_for(Responded, lambda one: "nectar" in one.text)


def test_what_is_typed_while_hearing_is_loaded_is_done_at_once(tmp_path, monkeypatch, reader):
    began, may_end = threading.Event(), threading.Event()

    def slow(self, language):
        began.set()
        assert may_end.wait(HUNG_S)

    monkeypatch.setattr(WatchedSpeechToText, "warm_up", slow)
    rig = VoiceRig(monkeypatch, tmp_path / "out.wav", robot="robot-apartment", model=reader)
    with ExitStack() as stack:
        stack.callback(rig.close)
        starting = threading.Thread(target=rig.start, name="test-start")
        starting.start()
        stack.callback(starting.join)
        stack.callback(may_end.set)
        assert began.wait(HUNG_S)

        rig.parts.conversation.submit(TextInput("go to the kitchen"))
        rig.wait_for(ToolCalled)

        assert rig.calls() == [KITCHEN]
        assert not may_end.is_set()
        assert not rig.parts.health.ready().well


def test_the_voice_is_loaded_after_hearing_and_before_the_prompt(tmp_path, monkeypatch, reader):
    order = []
    heard = composition.warm_up_hearing
    monkeypatch.setattr(
        composition, "warm_up_hearing", lambda *given: (heard(*given), order.append("hears"))
    )
    rig = VoiceRig(monkeypatch, tmp_path / "out.wav", robot="robot-apartment", model=reader)
    synthesiser = rig.parts.voice.speech_output.synthesiser
    prepare = synthesiser.prepare
    monkeypatch.setattr(synthesiser, "prepare", lambda: (prepare(), order.append("speaks")))

    def prime(messages, token):
        order.append("reads")
        reader.reads.set()

    monkeypatch.setattr(reader, "prime", prime)
    with rig:
        assert reader.reads.wait(HUNG_S)

    assert order[0] == "hears"
    assert "speaks" in order[: order.index("reads")]
