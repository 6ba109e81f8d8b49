"""A stop word that is spotted by its sound, and the words that follow: one stop, one answer."""

import phrases
import pytest
from support.body import FakeBody
from support.conversation import Talk

from edgevox.agent.stop.stopping import SAME_WORD_S
from edgevox.core.agent_events import (
    Confirmation,
    ConfirmationStatus,
    GoalCancelled,
    HeardBy,
    SafetyPreempted,
)
from edgevox.core.commands import Heard, StopSpotted, Transcribing
from edgevox.core.events import State, StateChanged

AT_S = 500.0
WISH = "I'd be so glad to see you in the kitchen"
STOPPED = SafetyPreempted("stop", stopped=True, heard_by=HeardBy.SPOTTER)


class Listening(Talk):
    """A conversation with a robot that drives on, and a listener that hears sounds."""

    def __init__(self, **more):
        super().__init__(FakeBody(), certain=True, **more)

    def answers(self):
        """All that was said but what a drive says itself."""
        return [one for one in self.said if not one.startswith("Going")]

    def spot(self, *, goes_on=True):
        self.conversation.submit(StopSpotted(AT_S, "stop", goes_on=goes_on))

    def listen(self, text, ended_s=AT_S, **more):
        self.conversation.submit(Transcribing())
        self.hear(text, ended_s, **more)


@pytest.fixture
def rig():
    with Listening() as talk:
        yield talk


def test_the_sound_of_a_stop_word_halts_before_its_words_are_known(rig):
    rig.begin("go to the kitchen")

    rig.spot()

    assert not rig.body.moving
    assert STOPPED in rig.of(SafetyPreempted)
    rig.settle()
    (ended,) = rig.of(GoalCancelled)
    assert ended.reason.code == "spotted_stop"


@pytest.mark.parametrize("text", ["Stop!", "", "Drive!", "go to the kitchen", "do not stop"])
def test_it_is_answered_once_whatever_its_words_read(rig, text):
    rig.begin("go to the kitchen")

    rig.spot()
    rig.settle()
    assert rig.answers() == []
    rig.listen(text, AT_S + 0.2, spotted=True)

    assert rig.answers()[-1:] == [phrases.said("stopped")]
    assert rig.answers().count(phrases.said("stopped")) == 1
    assert rig.of(SafetyPreempted) == [STOPPED]
    assert rig.body.sent == ["kitchen"]
    assert rig.of(StateChanged)[-1].state is State.LISTENING


def test_a_sound_in_no_utterance_is_answered_at_once(rig):
    rig.begin("go to the kitchen")

    rig.spot(goes_on=False)
    rig.settle()

    assert rig.answers() == [phrases.said("stopped")]


def test_the_words_of_an_utterance_that_was_over_before_the_sound_are_not_answered_again(rig):
    rig.begin("go to the kitchen")
    rig.spot(goes_on=False)
    rig.settle()

    rig.listen("Stop!", AT_S - 0.2)

    assert rig.answers() == [phrases.said("stopped")]
    assert rig.of(SafetyPreempted) == [STOPPED]
    assert rig.of(StateChanged)[-1].state is State.LISTENING


def test_a_stop_word_that_is_said_later_stops_by_its_words(rig):
    rig.spot(goes_on=False)
    rig.settle()
    rig.begin("go to the kitchen")

    rig.listen("stop", AT_S + 5.0)

    assert rig.of(SafetyPreempted)[-1] == SafetyPreempted("stop", stopped=True)
    assert rig.of(SafetyPreempted)[-1].heard_by == "words"


def test_nothing_moved_and_it_says_so_once(rig):
    rig.spot()
    rig.listen("stop", AT_S, spotted=True)

    assert rig.answers() == [phrases.said("standing")]


def test_two_sounds_in_one_utterance_are_answered_once(rig):
    rig.begin("go to the kitchen")

    rig.spot()
    rig.spot()
    rig.listen("stop stop", AT_S, spotted=True)

    assert rig.answers() == [phrases.said("stopped")]


def test_a_plain_order_in_the_rest_of_the_utterance_is_done(rig):
    rig.body.arrive()

    rig.spot()
    rig.listen("go to the bedroom", AT_S + 1.5, spotted=True)

    assert rig.body.sent == ["bedroom"]
    assert rig.answers() == ["I am in the bedroom."]


def test_where_nothing_is_going_on_words_that_sounded_like_a_stop_are_asked_about(rig):
    rig.body.arrive()

    rig.spot()
    rig.listen("go to the bedroom", AT_S, spotted=True)

    assert rig.body.sent == []
    assert rig.of(SafetyPreempted) == []
    rig.listen("yes", rig.clock.now() + 1.0)
    assert rig.body.sent == ["bedroom"]


def test_the_rest_of_the_utterance_is_asked_about_if_it_is_no_plain_order(rig):
    rig.spot()
    rig.listen(WISH, AT_S + 1.5, spotted=True)

    assert rig.body.sent == []
    assert [one.status for one in rig.of(Confirmation)] == [ConfirmationStatus.ASKED]


def test_without_a_stop_in_the_same_breath_the_same_words_are_done(rig):
    rig.body.arrive()

    rig.listen(WISH, AT_S + 1.5)

    assert rig.body.sent == ["kitchen"]


def test_stop_and_an_order_in_one_breath_stops_and_does_no_more(rig):
    rig.begin("go to the kitchen")

    rig.spot()
    rig.listen("stop, and go to the bedroom", AT_S + 1.5, spotted=True)

    assert rig.body.sent == ["kitchen"]
    assert rig.answers() == [phrases.said("stopped")]


@pytest.mark.parametrize(
    ("began_s", "ended_s", "asked"),
    [
        (None, AT_S - SAME_WORD_S - 0.5, False),
        (None, AT_S - 0.2, True),
        (AT_S - 0.3, AT_S + 5.0, True),
    ],
)
def test_where_nothing_is_going_on_a_sound_still_takes_back_what_was_said_before_it(
    rig, began_s, ended_s, asked
):
    rig.conversation.submit(Transcribing())

    rig.spot()
    rig.conversation.submit(Heard("go to the bedroom", ended_s, began_s=began_s))

    rig.settle()
    assert rig.body.sent == []
    assert [one.status for one in rig.of(Confirmation)] == [ConfirmationStatus.ASKED] * asked


def test_a_stop_that_comes_while_words_are_looked_into_is_no_later_than_they_are():
    def spells(text, _code):
        if text == "go to bedroom":  # the listener hears the stop at this very moment
            rig.spot(goes_on=False)
        return text

    with Listening(phonemes=spells) as rig:
        rig.begin("go to the kitchen")
        rig.listen("go to bedroom", AT_S - 0.5)

        assert rig.body.sent == ["kitchen"]


@pytest.mark.parametrize("goes_on", [True, False])
def test_where_nothing_is_going_on_it_listens_again_after_a_sound(rig, goes_on):
    rig.conversation.submit(Transcribing())

    rig.spot(goes_on=goes_on)
    rig.conversation.submit(Heard("", AT_S, spotted=goes_on))

    rig.settle()
    assert rig.of(StateChanged)[-1].state is State.LISTENING
