"""What of Whisper's output was said, and how sure it is."""

import math

import pytest

from edgevox.voice.stt.hallucinations import (
    Segment,
    confidence_in,
    parroted,
    plausible,
    words_of,
)


def segment(text, log_probability=-0.1):
    return Segment(text, no_speech=0.1, log_probability=log_probability, compression=1.0)


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("Turn left. Turn left.", "Turn left."),
        ("Go to the kitchen! go to the kitchen.", "Go to the kitchen!"),
        ("Turn left. Turn right.", "Turn left. Turn right."),
        ("Go to x 2.5, y 2.5.", "Go to x 2.5, y 2.5."),
        ("Turn left. Go on. Turn left.", "Turn left. Go on. Turn left."),
    ],
)
def test_a_sentence_that_is_written_again_was_said_once(written, said):
    assert words_of([segment(written)]) == said


def test_repetitions_are_found_across_segments():
    assert words_of([segment("Turn left."), segment("Turn left.")]) == "Turn left."


def test_words_are_as_sure_as_the_least_sure_of_their_segments():
    several = [segment("Go to the", -0.1), segment("kitchen.", -1.0)]

    assert confidence_in(several) == pytest.approx(math.exp(-1.0))


def test_no_words_leave_no_doubt():
    assert confidence_in([]) == 1.0


def test_words_that_are_hardly_likely_were_made_of_noise():
    assert plausible(segment("Go to the kitchen.", -0.85), seconds=1.5)
    assert not plausible(segment("Go to the kitchen.", -1.02), seconds=1.5)


@pytest.mark.parametrize(
    ("written", "log_probability", "is_parroted"),
    [
        (" Go to the kitchen.", -0.9, True),
        ("Turn left. Go to the kitchen!", -0.9, True),
        ("Go to the kitchen.", -0.3, False),
        ("Go to the office.", -0.9, False),
    ],
)
def test_what_hearing_was_shown_counts_only_if_it_is_likely(written, log_probability, is_parroted):
    prompt = "Go to the kitchen. Turn left."

    assert parroted(segment(written, log_probability), prompt) is is_parroted
