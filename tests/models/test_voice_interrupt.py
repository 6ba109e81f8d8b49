"""Interrupting the whole agent, in whatever state it is, with its real ears and mouth."""

import threading

import numpy as np
import pytest
from ears_rig import loud, says_espeak, silence
from guards import HUNG_S
from voice_engines import words
from voice_stage import Stage

from edgevox.agent.grammar import SAY
from edgevox.agent.history import CUT_MARK
from edgevox.core.agent_events import AgentEvent, GoalChanged, SafetyPreempted
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.events import Responded, State, StateChanged, Transcribed
from edgevox.voice.level import rms
from edgevox.voice.sinks.wav import WavFile

QUIET = silence(3.0)
"""So much of it, while the robot is heard, teaches the echo gate that nothing of it comes back."""
STORY = (
    "Once upon a time there was a robot in a house with four rooms and a corridor. ",
    "Every morning it went from one room to the next, and counted all the chairs. ",
)


class Teller:
    """A model that tells a story for minutes; asked to think, it thinks until it is stopped."""

    name, context_tokens = "teller", 4096

    def __init__(self):
        self.thinks, self.seen = threading.Event(), []

    def generate(self, messages, *, grammar, max_tokens, token):
        self.seen.append([message.content for message in messages])
        yield SAY
        if "think" in messages[-1].content:
            self.thinks.set()
            assert token.wait(HUNG_S)
            return
        yield from STORY * 10

    def prime(self, messages, token):
        """Nothing to read."""

    def count_tokens(self, text):
        return len(text.split())

    def close(self):
        """Nothing to free."""


@pytest.fixture(scope="module")
def teller():
    return Teller()


@pytest.fixture(scope="module")
def home(tmp_path_factory, teller):
    with pytest.MonkeyPatch.context() as patch:
        file = tmp_path_factory.mktemp("answers") / "answers.wav"
        with Stage(patch, file, aloud=True, robot="robot-apartment", model=teller) as stage:
            yield stage


@pytest.fixture
def stage(home):
    home.forget()
    return home


def states(stage):
    return [event.state for event in stage.of(StateChanged)]


def rested(stage):
    assert stage.parts.conversation.wait_idle(HUNG_S)
    return states(stage)[-1] is State.LISTENING


def test_while_it_thinks_nothing_is_said_and_the_next_turn_is_clean(stage, teller):
    submit = stage.parts.switchboard.submit
    submit(TextInput("please think about it"))
    assert teller.thinks.wait(HUNG_S)

    submit(Interrupt("enough"))

    assert rested(stage)
    assert states(stage) == [State.THINKING, State.INTERRUPTED, State.LISTENING]
    assert stage.of(Responded) == []
    assert not stage.answer().any()
    submit(TextInput("where are you"))
    assert stage.wait_for(Responded).text.startswith("I am in the")


def speaking(stage, monkeypatch, seconds=0.5):
    """Have the robot tell a story, and wait until so much of it was heard in the room."""
    heard, write, count = threading.Event(), WavFile.write, [0]

    def counted(self, samples, start_s):
        write(self, samples, start_s)
        count[0] += samples.size
        if count[0] >= seconds * self.rate_hz:
            heard.set()

    monkeypatch.setattr(WavFile, "write", counted)
    stage.parts.switchboard.submit(TextInput("tell me a story"))
    assert heard.wait(HUNG_S)


def test_while_it_speaks_what_is_remembered_is_what_was_heard(stage, teller, monkeypatch):
    speaking(stage, monkeypatch, 2.0)
    submit = stage.parts.switchboard.submit

    submit(Interrupt("enough"))

    cut = stage.wait_for(Responded)
    assert cut.cut
    assert rested(stage)
    aloud = words(stage.parts.voice.stt.transcribe(stage.answer(), "en"))
    assert len(aloud) >= 3
    assert words("".join(STORY * 10))[: len(words(cut.text))] == words(cut.text)
    assert abs(len(words(cut.text)) - len(aloud)) <= 2
    submit(TextInput("tell me another story"))
    stage.wait_for(StateChanged, lambda event: event.turn > cut.turn)
    submit(Interrupt("enough"))
    assert rested(stage)
    assert f"{cut.text}{CUT_MARK}" in " ".join(teller.seen[-1])


def test_what_is_being_transcribed_when_it_is_interrupted_is_not_done(stage, monkeypatch):
    stt, begun, go_on = stage.parts.voice.stt, threading.Event(), threading.Event()
    transcribe = stt.transcribe

    def held(samples, language):
        begun.set()
        assert go_on.wait(HUNG_S)
        return transcribe(samples, language)

    monkeypatch.setattr(stt, "transcribe", held)
    command = loud(says_espeak("go to the kitchen", "en-us"), 0.08)
    stage.room.play(np.concatenate([silence(0.5), command, silence(1.0)]))
    assert begun.wait(HUNG_S)

    stage.parts.switchboard.submit(Interrupt("enough"))
    go_on.set()
    stage.wait_for(StateChanged, lambda event: event.state is State.LISTENING)

    assert rested(stage)
    assert states(stage)[:2] == [State.TRANSCRIBING, State.INTERRUPTED]
    assert stage.of(Transcribed) == []
    assert stage.of(AgentEvent) == []


def test_a_person_who_speaks_over_it_cuts_it_and_is_understood(stage, monkeypatch):
    speaking(stage, monkeypatch)
    command = loud(says_espeak("where are you", "en-us"), 0.3)

    stage.room.play(np.concatenate([QUIET, command, silence(1.0)]))

    assert stage.wait_for(Responded).cut
    assert stage.wait_for(Responded, lambda event: not event.cut).text.startswith("I am in the")
    assert rms(stage.answer()) > 0.0


@pytest.mark.parametrize(("way", "room"), [("spoken", "bedroom"), ("typed", "kitchen")])
def test_a_stop_while_it_speaks_and_drives_halts_both(stage, way, room, monkeypatch):
    submit = stage.parts.switchboard.submit
    speaking(stage, monkeypatch)
    stage.parts.conversation.start_goal("navigate_to", {"room": room})
    stage.wait_for(GoalChanged, lambda event: event.status == "running")

    if way == "spoken":
        stop = loud(says_espeak("stop", "en-us"), 0.3)
        stage.room.play(np.concatenate([QUIET, stop, silence(1.0)]))
    else:
        submit(TextInput("stop"))

    halted = stage.wait_for(AgentEvent, lambda event: event.kind == "safety_preempt")
    assert halted == SafetyPreempted("stop", stopped=True)
    stage.wait_for(AgentEvent, lambda event: event.kind == "skill_cancelled")
    assert stage.wait_for(Responded).cut
    assert rested(stage)
    assert stage.body.state()["goal"] is None
    assert stage.body.velocity().linear_m_s == pytest.approx(0.0, abs=0.01)
