"""Words that are only heard where they are expected are less sure, and a motion asks then."""

import math

import pytest

from edgevox.agent.nlu.confidence import HEARD_FROM
from edgevox.core.commands import Hypothesis
from edgevox.voice.stt.expectation import LANGUAGES, doubted, is_doubtful
from edgevox.voice.stt.hallucinations import Segment
from edgevox.voice.stt.speech_to_text import Transcript


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
    assert language not in LANGUAGES
    assert not is_doubtful(Transcript("Pare.", 0.3), language)


def test_what_is_heard_without_expecting_it_is_as_sure_as_before():
    said = Transcript("Turn left.", 0.86)
    assert doubted(said, alone("Turn the left.", " turn left!")) == said


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
    assert doubted(Transcript("Turn left.", 0.899), alone(*heard)).confidence < HEARD_FROM


def test_what_else_may_have_been_said_is_judged_by_itself():
    others = (Hypothesis("Turn right.", 0.1, 0.8), Hypothesis("Turn it right.", 0.1, 0.7))
    said = doubted(Transcript("Turn left.", 0.85, others), alone("Turn it right."))
    right, it_right = said.others
    assert right.confidence < others[0].confidence
    assert it_right == others[1]
    assert math.isclose(sum(one.share for one in said.others), 0.2)
