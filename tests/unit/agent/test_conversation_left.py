"""What is left to another robot of a group, and what never is: stops, typed words, programs."""

import json
from dataclasses import replace

import pytest
from phrases import said
from support.clock import HeldClock
from support.conversation import Talk

from edgevox.core.agent_events import SafetyPreempted, UtteranceLeft
from edgevox.core.commands import Heard, RunSkill, Transcribing, Way
from edgevox.core.events import State, StateChanged, Transcribed
from edgevox.core.hearers import Hearers

MAX = {"id": "0123abcd", "name": "Max", "group": "hall", "beat": 3}


class Group:
    """A conversation and another robot, which is here and answers all that it claims."""

    def __init__(self) -> None:
        self.clock = HeldClock(1000.0)
        self.hearers = Hearers("Rosie", "hall", self.clock)
        self.talk = Talk(hearers=self.hearers, clock=self.clock)
        self.hearers.hear(json.dumps(MAX))

    def words(self, text: str) -> Heard:
        now_s = self.clock.now()
        return Heard(text, now_s - 0.5, began_s=now_s - 2.0)

    def max_answers(self) -> None:
        claim = {"utterance": 1, "ago_ms": 500, "lasted_ms": 1500, "answers": MAX["id"]}
        self.hearers.hear(json.dumps(MAX | claim))


@pytest.fixture
def group():
    one = Group()
    with one.talk:
        yield one


def test_words_that_another_robot_answers_are_shown_and_done_by_nobody_here(group):
    group.talk.conversation.submit(Transcribing())
    group.talk.conversation.submit(group.words("go to the kitchen"))
    group.talk.settle()
    assert group.talk.of(Transcribed) == []
    group.max_answers()
    group.talk.settle()
    assert group.talk.body.sent == []
    assert group.talk.said == []
    words, left = group.talk.of(Transcribed, UtteranceLeft)
    assert (words.text, words.turn, left.robot) == ("go to the kitchen", 0, "Max")
    assert group.talk.of(StateChanged)[-1].state is State.LISTENING


def test_words_for_this_robot_are_done_without_its_name(group):
    group.hearers.hear(json.dumps(MAX | {"leaving": True}))
    group.talk.conversation.submit(group.words("Rosie, go to the kitchen."))
    group.talk.settle()
    assert group.talk.body.sent == ["kitchen"]


def test_a_stop_word_stops_at_once_whoever_is_better_heard(group):
    group.max_answers()
    group.talk.begin("go to the kitchen")
    group.talk.conversation.submit(group.words("Max, stop!"))
    assert group.talk.of(SafetyPreempted) == [SafetyPreempted("stop", stopped=True)]
    assert not group.talk.body.moving
    group.talk.settle()
    assert group.talk.said[-1] == said("stopped")


def test_what_follows_a_stop_word_is_taken_up_by_one_robot(group):
    group.talk.begin("go to the kitchen")
    group.talk.conversation.submit(group.words("wait, go to the office"))
    assert not group.talk.body.moving
    group.max_answers()
    group.talk.settle()
    assert group.talk.body.sent == ["kitchen"]
    assert group.talk.questions == []
    assert [one.robot for one in group.talk.of(UtteranceLeft)] == ["Max"]
    assert group.talk.said[-1] == said("stopped")


def test_a_stop_makes_void_what_was_not_decided_yet(group):
    group.talk.conversation.submit(group.words("go to the kitchen"))
    group.talk.say("stop")
    group.hearers.hear(json.dumps(MAX | {"leaving": True}))
    group.hearers.beat()
    group.talk.settle()
    assert group.talk.body.sent == []


def test_typed_words_words_to_its_page_and_commands_are_nobody_elses(group):
    group.max_answers()
    group.talk.say("go to the kitchen")
    spoken = replace(group.words("go to the bedroom"), way=Way.CONSOLE_OPERATOR)
    group.talk.conversation.submit(spoken)
    group.talk.settle()
    group.talk.conversation.submit(RunSkill("navigate_to", {"room": "office"}))
    group.talk.settle()
    assert group.talk.body.sent == ["kitchen", "bedroom", "office"]
    assert group.talk.of(UtteranceLeft) == []
