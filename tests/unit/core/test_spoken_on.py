"""Who speaks on after words that were acted on: what began for them ends, and the whole counts."""

import pytest
from support.body import FakeBody
from support.conversation import Talk

from edgevox.core.agent_events import GoalCancelled, SafetyPreempted
from edgevox.core.commands import Heard, SpokenOn
from edgevox.core.events import State, StateChanged, Transcribed

AT_S = 500.0


@pytest.fixture
def rig():
    with Talk(FakeBody(), certain=True) as talk:
        yield talk


def say(rig, text, ended_s=AT_S):
    rig.conversation.submit(Heard(text, ended_s))
    rig.body.starts()


def test_the_drive_that_began_for_the_first_part_ends_at_once(rig):
    say(rig, "go to the kitchen")

    rig.conversation.submit(SpokenOn(AT_S))

    rig.settle()
    assert not rig.body.moving
    assert len(rig.of(GoalCancelled)) == 1
    assert rig.of(SafetyPreempted) == []
    assert rig.of(StateChanged)[-1].state is State.LISTENING


def test_the_whole_is_done_instead(rig):
    say(rig, "go to the kitchen")
    rig.conversation.submit(SpokenOn(AT_S))
    rig.settle()

    say(rig, "go to the bedroom", AT_S + 2.0)

    assert rig.body.sent == ["kitchen", "bedroom"]
    assert rig.body.moving


def test_what_was_begun_by_others_goes_on(rig):
    rig.begin("go to the kitchen")
    rig.first_answer(Heard("where are you", AT_S))

    rig.conversation.submit(SpokenOn(AT_S))

    assert rig.body.moving
    assert rig.of(GoalCancelled) == []


def test_words_that_come_after_they_were_taken_back_are_not_done(rig):
    rig.conversation.submit(SpokenOn(AT_S))

    rig.hear("go to the kitchen", AT_S)

    assert rig.body.sent == []
    assert rig.of(Transcribed) == []


def test_a_stop_is_not_taken_back(rig):
    rig.begin("go to the kitchen")
    rig.conversation.submit(SpokenOn(AT_S))

    rig.hear("stop", AT_S)

    assert rig.of(SafetyPreempted) == [SafetyPreempted("stop", stopped=True)]
