"""A stop word that is spotted by its sound, and the words that follow: one stop, one answer."""

import pytest
from clocks import HeldClock
from fake_body import FakeBody
from waiting import Heard as Told

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.nlu.confidence import read_head
from edgevox.agent.nlu.decider import Decider
from edgevox.core.agent_events import (
    AgentEvent,
    Confirmation,
    ConfirmationStatus,
    GoalCancelled,
    HeardBy,
    SafetyPreempted,
)
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, StopSpotted, TextInput, Transcribing
from edgevox.core.events import Responded, State, StateChanged, Transcribed, TurnEnded

AT_S = 50.0
WISH = "I'd be so glad to see you in the kitchen"
STOPPED = SafetyPreempted("stop", stopped=True, heard_by=HeardBy.SPOTTER)


class Certain:
    """An encoder for which every sentence is an order, without any doubt."""

    def features(self, text):
        head = read_head()
        weights = head.order_weights
        return (weights * (12.0 - head.order_bias) / float(weights @ weights)).astype("float32")


class Rig:
    """A conversation with a robot that goes to rooms until it is stopped, and what it tells."""

    def __init__(self):
        self.bus, self.told, self.body = Bus(), Told(), FakeBody()
        for kind in (Responded, StateChanged, Transcribed, AgentEvent, TurnEnded):
            self.bus.subscribe(kind, self.told.add)
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", self.body.skills("navigate_to"))],
            self.bus,
            halt=self.body.halt,
            clock=HeldClock(100.0),
            decider=Decider(Certain(), read_head()),
        )

    def of(self, kind):
        return [event for event in self.told.messages if isinstance(event, kind)]

    def answers(self):
        """All that was said but what a drive says itself."""
        return [one.text for one in self.of(Responded) if not one.text.startswith("Going")]

    def drive(self):
        self.conversation.submit(TextInput("go to the kitchen"))
        self.body.starts()
        self.told.wait_for(lambda event: isinstance(event, TurnEnded))

    def spot(self, *, goes_on=True):
        self.conversation.submit(StopSpotted(AT_S, "stop", goes_on=goes_on))

    def hear(self, text, ended_s=AT_S, **more):
        self.conversation.submit(Transcribing())
        self.conversation.submit(Heard(text, ended_s, **more))
        assert self.conversation.wait_idle(60)


@pytest.fixture
def rig():
    found = Rig()
    found.conversation.start()
    yield found
    found.body.arrive()
    found.conversation.close()


def test_the_sound_of_a_stop_word_halts_before_its_words_are_known(rig):
    rig.drive()

    rig.spot()

    assert not rig.body.moving
    assert STOPPED in rig.told.messages
    assert rig.conversation.wait_idle(60)
    (ended,) = rig.of(GoalCancelled)
    assert ended.reason.code == "spotted_stop"


@pytest.mark.parametrize("text", ["Stop!", "", "Drive!", "go to the kitchen", "do not stop"])
def test_it_is_answered_once_whatever_its_words_read(rig, text):
    rig.drive()

    rig.spot()
    assert rig.conversation.wait_idle(60)
    assert rig.answers() == []
    rig.hear(text, AT_S + 0.2, spotted=True)

    assert rig.answers()[-1:] == ["Stopped."]
    assert rig.answers().count("Stopped.") == 1
    assert rig.of(SafetyPreempted) == [STOPPED]
    assert rig.body.sent == ["kitchen"]
    assert rig.of(StateChanged)[-1].state is State.LISTENING


def test_a_sound_in_no_utterance_is_answered_at_once(rig):
    rig.drive()

    rig.spot(goes_on=False)
    assert rig.conversation.wait_idle(60)

    assert rig.answers() == ["Stopped."]


def test_the_words_of_an_utterance_that_was_over_before_the_sound_are_not_answered_again(rig):
    rig.drive()
    rig.spot(goes_on=False)
    assert rig.conversation.wait_idle(60)

    rig.hear("Stop!", AT_S - 0.2)

    assert rig.answers() == ["Stopped."]
    assert rig.of(SafetyPreempted) == [STOPPED]


def test_a_stop_word_that_is_said_later_stops_by_its_words(rig):
    rig.spot(goes_on=False)
    assert rig.conversation.wait_idle(60)
    rig.drive()

    rig.hear("stop", AT_S + 5.0)

    assert rig.of(SafetyPreempted)[-1] == SafetyPreempted("stop", stopped=True)
    assert rig.of(SafetyPreempted)[-1].heard_by == "words"


def test_nothing_moved_and_it_says_so_once(rig):
    rig.spot()
    rig.hear("stop", AT_S, spotted=True)

    assert rig.answers() == ["I am standing still."]


def test_two_sounds_in_one_utterance_are_answered_once(rig):
    rig.drive()

    rig.spot()
    rig.spot()
    rig.hear("stop stop", AT_S, spotted=True)

    assert rig.answers() == ["Stopped."]


def test_a_plain_order_in_the_rest_of_the_utterance_is_done(rig):
    rig.body.arrive()

    rig.spot()
    rig.hear("go to the bedroom", AT_S + 1.5, spotted=True)

    assert rig.body.sent == ["bedroom"]
    assert rig.answers()[0] == "I am standing still."


def test_the_rest_of_the_utterance_is_asked_about_if_it_is_no_plain_order(rig):
    rig.spot()
    rig.hear(WISH, AT_S + 1.5, spotted=True)

    assert rig.body.sent == []
    assert [one.status for one in rig.of(Confirmation)] == [ConfirmationStatus.ASKED]


def test_without_a_stop_in_the_same_breath_the_same_words_are_done(rig):
    rig.body.arrive()

    rig.hear(WISH, AT_S + 1.5)

    assert rig.body.sent == ["kitchen"]


def test_stop_and_an_order_in_one_breath_stops_and_does_no_more(rig):
    rig.drive()

    rig.spot()
    rig.hear("stop, and go to the bedroom", AT_S + 1.5, spotted=True)

    assert rig.body.sent == ["kitchen"]
    assert rig.answers() == ["Stopped."]
