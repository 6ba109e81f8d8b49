"""What a person may say without the wake word, shortly after the robot spoke to that person."""

from dataclasses import replace

import pytest
from support.conversation import Talk

from edgevox.agent.dialogue.question import EXPIRES_S
from edgevox.core.agent_events import GoalChanged
from edgevox.core.commands import Heard, Hypothesis, TextInput
from edgevox.core.events import TurnEnded

WITHIN_S = 8.0


def takes(talk: Talk, text: str, *, after_s: float = 1.0, confidence: float = 1.0) -> bool:
    """Whether words count that begin so long after what was said last, and last half a second."""
    began_s = talk.clock.now_s + after_s
    heard = Heard(text, began_s + 0.5, confidence=confidence, began_s=began_s)
    return talk.conversation.follow_ups.takes(heard)


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


def misheard(talk: Talk, text: str, *others: str) -> Heard:
    """Words by a second after what was said last, and what else they may have been."""
    began_s = talk.clock.now_s + 1.0
    maybe = tuple(Hypothesis(one, 0.3, 0.8) for one in others)
    return Heard(text, began_s + 0.5, confidence=0.7, others=maybe, began_s=began_s)


@pytest.mark.parametrize(
    ("text", "other", "then"),
    [
        ("Delta.", "Yeah.", "Shall I go to the kitchen?"),
        ("Short go.", "Sure, go.", "Shall I go to the kitchen?"),
        ("Go now.", "Oh, no.", "All right, I leave it."),
        ("Know the office.", "No, the office.", "Shall I go to the office?"),
    ],
)
def test_an_answer_that_was_misheard_is_asked_for_again_or_declines(
    text: str, other: str, then: str
) -> None:
    with Talk(confirm="always") as talk:
        talk.hear("go to the kitchen")
        heard = misheard(talk, text, other)

        assert talk.conversation.follow_ups.takes(heard)
        talk.clock.advance(2.0)
        assert [one.text for one in talk.answers_to(heard)] == [then]
        assert not talk.of(GoalChanged)


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("Delta.", "Dealt her."),
        ("Turn the page over now.", "Yes."),
        ("where are you", "Yes."),
        ("the stop is near", "Yes."),
    ],
)
def test_words_that_mean_something_else_or_are_many_are_no_misheard_answer(
    text: str, other: str
) -> None:
    with Talk(confirm="always") as talk:
        talk.hear("go to the kitchen")
        heard = replace(misheard(talk, text, other), confidence=0.5)

        assert not talk.conversation.follow_ups.takes(heard)


def test_nothing_is_taken_for_an_answer_where_nothing_was_asked() -> None:
    with Talk(follow_up_s=WITHIN_S) as talk:
        talk.hear("where are you")
        assert not talk.conversation.follow_ups.takes(misheard(talk, "Delta.", "Yes."))


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
