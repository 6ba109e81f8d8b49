"""What a person may say without the wake word, shortly after the robot spoke to that person."""

import pytest
from support.conversation import Talk

from edgevox.agent.dialogue.question import EXPIRES_S
from edgevox.core.commands import Heard, TextInput
from edgevox.core.events import TurnEnded

WITHIN_S = 8.0


def takes(talk: Talk, text: str, *, after_s: float = 1.0, confidence: float = 1.0) -> bool:
    """Whether words count that begin so long after what was said last, and last half a second."""
    began_s = talk.clock.now_s + after_s
    return talk.conversation.follow_ups.takes(text, confidence, began_s, began_s + 0.5)


@pytest.mark.parametrize(
    "text", ["yes", "yes, please", "no", "no, the office", "the office", "go to the office"]
)
def test_a_question_is_answered_without_the_wake_word(text):
    with Talk(confirm="always") as talk:
        talk.hear("go to the kitchen")
        assert takes(talk, text, after_s=EXPIRES_S - 1.0)


@pytest.mark.parametrize(
    "text", ["we had lunch", "the kitchen was painted yesterday", "yes we had lunch", "maybe later"]
)
def test_what_others_say_is_no_answer(text):
    with Talk(confirm="always") as talk:
        talk.hear("go to the kitchen")
        assert not takes(talk, text)


def test_a_question_that_has_expired_takes_no_answer_more():
    with Talk(confirm="always", follow_up_s=WITHIN_S) as talk:
        talk.hear("go to the kitchen")
        talk.clock.advance(EXPIRES_S + 1.0)
        assert not takes(talk, "yes")


def test_after_its_answer_a_plain_command_counts_for_a_while_and_nothing_else():
    with Talk(follow_up_s=WITHIN_S) as talk:
        talk.hear("where are you")
        assert takes(talk, "go to the kitchen", after_s=WITHIN_S)
        assert not takes(talk, "go to the kitchen", after_s=WITHIN_S + 0.1)
        assert not takes(talk, "yes")
        assert not takes(talk, "she goes to the kitchen every morning")


def test_a_no_while_it_drives_is_for_it():
    with Talk() as talk:
        assert not takes(talk, "no")
        talk.body.drive_on()
        talk.first_answer(Heard("go to the kitchen", talk.clock.now()))
        talk.until(lambda: talk.of(TurnEnded))
        assert takes(talk, "no")
        assert takes(talk, "no, the office")


@pytest.mark.parametrize(
    ("text", "least"), [("go to the office", 0.6), ("the office", 0.6), ("yes", 0.4), ("no", 0.3)]
)
def test_words_that_were_heard_badly_are_for_nobody(text: str, least: float) -> None:
    with Talk(confirm="always") as talk:
        talk.hear("go to the kitchen")
        assert takes(talk, text, confidence=least)
        assert not takes(talk, text, confidence=least - 0.05)


def test_a_choice_is_answered_without_the_wake_word() -> None:
    with Talk() as talk:
        talk.hear("go to the kitchen or the office")
        assert takes(talk, "the office")


def test_typed_words_make_it_listen_to_nobody():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        assert not takes(talk, "yes")
        talk.say("where are you")
        assert not takes(talk, "go to the office")


@pytest.mark.parametrize("stop", ["stop", "stop everything"])
def test_after_a_stop_nothing_is_awaited(stop):
    with Talk() as talk:
        talk.hear("where are you")
        assert takes(talk, "go to the kitchen")
        talk.answers_to(TextInput(stop))
        assert not takes(talk, "go to the kitchen")


def test_none_is_awaited_where_the_setting_says_so():
    with Talk(confirm="always", follow_up_s=0.0) as talk:
        talk.hear("go to the kitchen")
        assert not takes(talk, "yes")
        talk.hear("where are you")
        assert not takes(talk, "go to the office")
