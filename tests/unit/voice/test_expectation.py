"""Words that are only heard where they are expected are less sure, and a motion asks then; those
that are heard without expecting them, too, are surer."""

import math

import pytest

from edgevox.agent.nlu.meaning import HEARD_FROM
from edgevox.core.commands import Hypothesis
from edgevox.voice.stt.speech_to_text import (
    AROUND_S,
    BYTES_A_SECOND,
    SHOWN_COMMANDS,
    Segment,
    Transcript,
    both,
    heard_again,
    is_doubtful,
    transcript_of,
)


def alone(*texts):
    """What is heard without expecting anything: each e times less likely than the one before."""
    return [Segment(text, 0.1, -0.2, 0.7, -float(at)) for at, text in enumerate(texts)]


@pytest.mark.parametrize(
    ("said", "again"), [("", False), ("Turn left.", True), ("Go to the kitchen.", True)]
)
def test_what_is_not_sure_is_listened_to_again(said, again):
    assert is_doubtful(Transcript(said, 0.89), "en") is again
    assert not is_doubtful(Transcript(said, 0.9), "en")


@pytest.mark.parametrize("language", ["pt", "de"])
def test_a_language_in_which_no_commands_are_expected_is_listened_to_once(language):
    assert language not in SHOWN_COMMANDS
    assert not is_doubtful(Transcript("Pare.", 0.3), language)


def test_what_is_heard_without_expecting_it_too_is_surer():
    before = Segment("Turn left.", 0.1, math.log(0.64), 0.7)
    for heard in (alone(" turn left!"), alone("Turn the left.", "Turn left")):
        assert math.isclose(heard_again(heard)(before), 0.8)


def test_what_is_only_thought_of_without_expecting_it_is_as_sure_as_before():
    before = Segment("Turn left.", 0.1, math.log(0.64), 0.7)
    heard = [*alone("Turn the left."), Segment("Turn left.", 0.1, -0.2, 0.7, -1.5)]
    assert math.isclose(heard_again(heard)(before), 0.64)


@pytest.mark.parametrize(
    "heard",
    [
        ["Turn the left.", "Turn the lap."],  # "Turn around." beside a vacuum cleaner
        ["Robot."],
        ["Turn the left.", "Turn away.", "Turn up.", "Turn left."],  # e³ times less likely
        [],
    ],
)
def test_a_motion_that_is_only_expected_needs_a_yes(heard):
    before = Segment("Turn left.", 0.1, math.log(0.899), 0.7)
    assert heard_again(alone(*heard))(before) < HEARD_FROM


def test_each_thing_that_may_have_been_said_is_judged_by_itself():
    found = alone("Turn left.", "Turn right.", "Turn it right.")
    before = transcript_of(found, 1.0, "")
    said = transcript_of(found, 1.0, "", heard_again(alone("Turn it right.")))
    right, it_right = said.others
    assert right.confidence < before.others[0].confidence
    assert it_right.confidence > before.others[1].confidence
    assert [one.share for one in said.others] == [one.share for one in before.others]


def test_words_that_are_too_few_for_the_sound_stay_less_sure_when_heard_twice():
    found = [Segment("Walk.", 0.1, math.log(0.81), 0.7)]
    whole = transcript_of(found, 0.9, "", heard_again(found))
    half = transcript_of(
        found, AROUND_S + 2 * len("Walk.") / BYTES_A_SECOND, "", heard_again(found)
    )
    assert math.isclose(whole.confidence, 0.9)
    assert math.isclose(half.confidence, 0.45)


def test_what_two_hearings_agree_on_is_what_was_said():
    one = Transcript("Turn the lap.", 0.7, (Hypothesis("Turn left.", 0.4, 0.6),))
    other = Transcript("turn left", 0.8, (Hypothesis("Turn up.", 0.1, 0.5),))

    said = both(one, other)

    assert (said.text, said.confidence) == ("Turn left.", 0.8)
    assert [(one.text, one.share) for one in said.others] == [
        ("Turn the lap.", pytest.approx(0.3)),
        ("Turn up.", pytest.approx(0.05)),
    ]


@pytest.mark.parametrize(
    ("one", "other"), [("", "Go."), ("Go.", ""), ("", "")], ids=["first", "second", "neither"]
)
def test_a_second_hearing_makes_no_words_of_nothing_and_takes_none_away(one, other):
    assert both(Transcript(one, 0.5), Transcript(other, 0.5)).text == one


def test_of_two_hearings_that_differ_both_remain():
    said = both(Transcript("Turn left.", 0.8), Transcript("Turn right.", 0.7))

    assert said.text == "Turn left."
    assert [(one.text, one.share) for one in said.others] == [("Turn right.", 0.5)]
