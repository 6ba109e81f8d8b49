"""What a robot that talks does while its language model, its voice or its hearing is not there yet.

The order of events says so, not a number of seconds: the test holds what is slow, and lets it go.
"""

import threading
from contextlib import ExitStack

import numpy as np
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, silence
from support.conversation import Eloquent
from voice_rig import SLOWLY, VoiceRig

from edgevox.agent.llm.protocol import SAY
from edgevox.core.agent_events import ToolCalled
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded
from edgevox.voice.stt.speech_to_text import WatchedSpeechToText

KITCHEN, OFFICE = (("navigate_to", {"room": room}) for room in ("kitchen", "office"))


class SlowReader(Eloquent):
    """A model that reads its prompt until the test lets it; chats wait for that."""

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

    def close(self):
        self.may_end.set()


@pytest.fixture
def reader():
    one = SlowReader()
    yield one
    one.may_end.set()


@pytest.fixture
def started(tmp_path, monkeypatch, reader):
    """A robot that starts until its hearing is to be loaded; with what goes on, and its order."""
    began, may_load, order = threading.Event(), threading.Event(), []
    warm_up, prime = WatchedSpeechToText.warm_up, reader.prime

    def load(self, language):
        began.set()
        assert may_load.wait(HUNG_S)
        warm_up(self, language)
        order.append("hears")

    def read(messages, token):
        order.append("reads")
        prime(messages, token)

    monkeypatch.setattr(WatchedSpeechToText, "warm_up", load)
    monkeypatch.setattr(reader, "prime", read)
    more = {"model": reader, "speed": SLOWLY, "voice": "espeak-en"}
    rig = VoiceRig(monkeypatch, tmp_path / "out.wav", robot="robot-apartment", **more)
    synthesiser = rig.parts.voice.speech_output.synthesiser
    prepare = synthesiser.prepare
    monkeypatch.setattr(synthesiser, "prepare", lambda: (prepare(), order.append("speaks")))
    with ExitStack() as stack:
        stack.callback(rig.close)
        starting = threading.Thread(target=rig.start, name="test-start")
        starting.start()
        stack.callback(starting.join)
        stack.callback(may_load.set)
        assert began.wait(HUNG_S)
        yield rig, may_load, order


def spoken(text):
    return np.concatenate([silence(0.5), loud(says_espeak(text, "en-us"), 0.08), silence(1.5)])


def test_what_can_be_done_is_done_while_hearing_then_the_voice_then_the_prompt_are_loaded(
    started, reader
):
    rig, may_load, order = started

    # Typed, while hearing is loaded.
    rig.parts.conversation.submit(TextInput("go to the kitchen"))
    rig.wait_for(ToolCalled)
    assert rig.calls() == [KITCHEN]
    assert "hears" not in order
    assert not rig.parts.health.ready().well

    # Spoken, while the language model reads its prompt.
    may_load.set()
    assert reader.reads.wait(HUNG_S)
    assert order[0] == "hears"
    assert "speaks" in order[: order.index("reads")]
    rig.forget()
    rig.room.play(spoken("go to the office"))
    rig.wait_for(ToolCalled)
    assert rig.calls() == [OFFICE]
    rig.room.play(spoken("stop"))
    rig.wait_for(Responded, lambda one: one.text.startswith("Stopped"))

    # What needs the model waits until it has read.
    rig.parts.conversation.submit(TextInput("how do bees make honey"))
    assert not any("nectar" in one.text for one in rig.of(Responded))
    assert not reader.may_end.is_set()
    reader.may_end.set()
    rig.wait_for(Responded, lambda one: "nectar" in one.text)
