"""Interrupting the whole agent, in whatever state it is, with real speech in and out."""

import math
import threading

import numpy as np
import phrases
import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, says_piper, silence
from support.conversation import Eloquent
from voice_engines import words
from voice_rig import SLOWLY
from waiting import wait_until

from edgevox.agent.llm.prompt import CUT_MARK
from edgevox.agent.llm.protocol import SAY
from edgevox.core.agent_events import AgentEvent, GoalChanged, SafetyPreempted
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.events import Interrupted, Responded, State, StateChanged, Transcribed
from edgevox.voice.audio import RATE_HZ, rms
from edgevox.voice.sinks.open_sink import WavFile

QUIET = silence(3.0)
"""So much of it, while the robot is heard, teaches the echo gate that nothing of it comes back."""
BRAKES_M = 0.3
"""From 0.8 m/s, at 2 m/s^2, and what passes until this looks where it is."""
STORY = (
    "Once upon a time there was a robot in a house with four rooms and a corridor. ",
    "Every morning it went from one room to the next, and counted all the chairs. ",
)


class Teller(Eloquent):
    """A model that tells a story for minutes; asked to think, it thinks until it is stopped."""

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


@pytest.fixture(scope="module")
def teller():
    return Teller()


@pytest.fixture(scope="module")
def home_with(teller):
    return {"aloud": True, "model": teller, "speed": SLOWLY}


def states(rig):
    return [event.state for event in rig.of(StateChanged)]


def rested(rig):
    assert rig.parts.conversation.wait_idle(HUNG_S)
    return states(rig)[-1] is State.LISTENING


def test_while_it_thinks_nothing_is_said_and_the_next_turn_is_clean(rig, teller):
    submit = rig.parts.command_router.submit
    submit(TextInput("how do whales think?"))
    assert teller.thinks.wait(HUNG_S)

    submit(Interrupt("enough"))

    assert rested(rig)
    assert states(rig) == [State.THINKING, State.INTERRUPTED, State.LISTENING]
    assert rig.of(Responded) == []
    assert not rig.answer().any()
    submit(TextInput("where are you"))
    assert rig.wait_for(Responded).text.startswith("I am in the")


def speaking(rig, monkeypatch, seconds=0.5):
    """Have the robot tell a story, and wait until so much of it was heard in the room.

    Returns what tells how many samples were heard so far.
    """
    heard, write, count = threading.Event(), WavFile.write, [0]

    def counted(self, samples, start_s):
        write(self, samples, start_s)
        count[0] += samples.size
        if count[0] >= seconds * self.rate_hz:
            heard.set()

    monkeypatch.setattr(WavFile, "write", counted)
    rig.parts.command_router.submit(TextInput("why does ice float?"))
    assert heard.wait(HUNG_S)
    return lambda: count[0]


def test_while_it_speaks_what_is_remembered_is_what_was_heard(rig, teller, monkeypatch):
    speaking(rig, monkeypatch, 2.0)
    submit = rig.parts.command_router.submit

    submit(Interrupt("enough"))

    cut = rig.wait_for(Responded)
    assert cut.cut
    assert rested(rig)
    aloud = words(rig.parts.voice.stt.transcribe(rig.answer(), "en").text)
    assert len(aloud) >= 3
    assert words("".join(STORY * 10))[: len(words(cut.text))] == words(cut.text)
    assert abs(len(words(cut.text)) - len(aloud)) <= 2
    submit(TextInput("why do boats float?"))
    rig.wait_for(StateChanged, lambda event: event.turn > cut.turn)
    submit(Interrupt("enough"))
    assert rested(rig)
    assert f"{cut.text}{CUT_MARK}" in " ".join(teller.seen[-1])


def test_what_is_being_transcribed_when_it_is_interrupted_is_not_done(rig, monkeypatch):
    stt, begun, go_on = rig.parts.voice.stt, threading.Event(), threading.Event()
    transcribe = stt.transcribe

    def held(samples, language):
        begun.set()
        assert go_on.wait(HUNG_S)
        return transcribe(samples, language)

    monkeypatch.setattr(stt, "transcribe", held)
    command = loud(says_espeak("go to the kitchen", "en-us"), 0.08)
    rig.room.play(np.concatenate([silence(0.5), command, silence(2.0)]))
    assert begun.wait(HUNG_S)
    rig.wait_for(StateChanged, lambda event: event.state is State.TRANSCRIBING)

    rig.parts.command_router.submit(Interrupt("enough"))
    go_on.set()
    rig.wait_for(StateChanged, lambda event: event.state is State.LISTENING)

    assert rested(rig)
    assert states(rig)[:2] == [State.TRANSCRIBING, State.INTERRUPTED]
    assert rig.of(Transcribed) == []
    assert rig.of(AgentEvent) == []


def test_a_person_who_speaks_over_it_cuts_it_and_is_understood(rig, monkeypatch):
    speaking(rig, monkeypatch)
    command = loud(says_espeak("where are you", "en-us"), 0.3)

    rig.room.play(np.concatenate([QUIET, command, silence(1.0)]))

    assert rig.wait_for(Responded).cut
    assert rig.wait_for(Responded, lambda event: not event.cut).text.startswith("I am in the")
    assert rms(rig.answer()) > 0.0


@pytest.mark.parametrize("words", ["yeah", "okay", "I see"])
def test_a_person_who_only_listens_does_not_end_its_answer(rig, words, monkeypatch):
    heard = speaking(rig, monkeypatch)
    sound = loud(says_piper(words), 0.3)

    rig.room.play(np.concatenate([QUIET, sound, silence(2.0)]))
    assert rig.parts.listener.transcriber.wait_idle(HUNG_S)

    then = heard()  # on a slow machine its answer may be over before the words are understood
    wait_until(lambda: heard() > then + RATE_HZ or rig.of(Responded), "going on, or its end")
    assert [one.cut for one in rig.of(Responded)] in ([], [False])
    assert rig.of(Interrupted) == []


@pytest.mark.parametrize(("way", "room"), [("spoken", "bedroom"), ("typed", "kitchen")])
def test_a_stop_while_it_speaks_and_drives_halts_both(rig, way, room, monkeypatch):
    submit = rig.parts.command_router.submit
    speaking(rig, monkeypatch)
    rig.parts.conversation.start_goal("navigate_to", {"room": room})
    rig.wait_for(GoalChanged, lambda event: event.status == "running")

    if way == "spoken":
        stop = loud(says_espeak("stop", "en-us"), 0.3)
        rig.room.play(np.concatenate([QUIET, stop, silence(1.0)]))
    else:
        submit(TextInput("stop"))

    halted = rig.wait_for(AgentEvent, lambda event: event.kind == "safety_preempt")
    assert isinstance(halted, SafetyPreempted)
    assert (halted.word, halted.stopped) == ("stop", True)
    at = rig.body.pose()
    rig.wait_for(AgentEvent, lambda event: event.kind == "skill_cancelled")
    assert rig.wait_for(Responded).cut
    rig.wait_for(Responded, lambda event: event.text == phrases.said("stopped"))
    assert rested(rig)
    assert rig.body.state()["goal"] is None
    wait_until(lambda: abs(rig.body.velocity().linear_m_s) < 0.01, "standing")
    stood = rig.body.pose()
    assert math.hypot(stood.x_m - at.x_m, stood.y_m - at.y_m) < BRAKES_M
