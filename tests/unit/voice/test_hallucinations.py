"""What of Whisper's output was said, and how sure it is."""

import math

import pytest

from edgevox.agent.nlu.meaning import HEARD_FROM
from edgevox.voice.stt.speech_to_text import (
    Segment,
    Transcript,
    only_alone,
    parroted,
    plausible,
    stop_word_parroted,
    transcript_of,
    words_of,
)


def segment(text, log_probability=-0.1):
    return Segment(text, no_speech=0.1, log_probability=log_probability, compression=1.0)


def likely(text, share, token=0.8):
    """A hypothesis with so great a share, and tokens that are so likely each."""
    return Segment(text, 0.1, math.log(token), compression=1.0, whole=math.log(share))


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
    assert words_of(written) == said


@pytest.mark.parametrize(("token", "said"), [(0.95, "Where are you?"), (0.8, "")])
def test_words_that_are_all_sure_were_said_though_nobody_seemed_to_speak(token, said):
    heard = Segment("Where are you?", 0.66, math.log(token), compression=1.0)

    assert transcript_of([heard], 1.3, "").text == said


def test_what_else_may_have_been_said_has_its_share_and_other_spellings_are_the_same():
    said = transcript_of(
        [likely("Turn left.", 0.5), likely("Turn around.", 0.3), likely("turn left!", 0.2)], 1.3, ""
    )

    assert (said.text, said.confidence) == ("Turn left.", pytest.approx(0.8))
    assert [(one.text, one.share, one.confidence) for one in said.others] == [
        ("Turn around.", pytest.approx(0.3), pytest.approx(0.8))
    ]


def test_what_is_hardly_likely_is_left_out():
    said = transcript_of([likely("Turn left.", 0.99), likely("Turn around.", 0.01)], 1.5, "")

    assert said.others == ()


@pytest.mark.parametrize(
    ("text", "seconds", "sure"),
    [
        ("Walk backward half a meter.", 2.0, 0.8),
        ("Walk backward.", 1.3, 0.8),
        ("Walk backward.", 2.0, 0.8 * 14 / (12 * 1.45)),  # "half a metre" is missing
        ("Turn left.", 0.3, 0.8),
        ("キッチンに行って", 2.0, 0.8),
    ],
)
def test_words_that_are_too_few_for_the_sound_are_less_sure(text, seconds, sure):
    said = transcript_of([likely(text, 0.7), likely("Go.", 0.3)], seconds, "")

    assert said.confidence == pytest.approx(sure)
    assert said.others[0].confidence <= sure


def test_if_the_likeliest_was_not_said_nothing_was():
    after_a_film = [likely("Thanks for watching!", 0.6), likely("Go to the kitchen.", 0.4)]

    assert transcript_of(after_a_film, 4.0, "") == Transcript("")
    assert transcript_of([], 4.0, "") == Transcript("")


def test_what_was_parroted_is_not_among_what_may_have_been_said():
    said = transcript_of(
        [likely("Get your place.", 0.6, 0.5), likely("Turn left.", 0.4, 0.5)], 1.5, "Turn left."
    )

    assert (said.text, said.others) == ("Get your place.", ())


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


@pytest.mark.parametrize(
    ("said", "without", "is_parroted"),
    [
        ("Halt!", ["On.", "Hon."], True),
        ("Stop! Halt!", ["Up.", "Hop."], True),
        ("Halt!", ["Hall.", "Halt."], False),
        ("Halt!", ["Oh.", "No.", "Ho!", "Halt."], True),
        ("Halt!", ["Yeah, halt.", "Hey, halt."], False),
        ("Kitchen.", ["Chicken."], False),
        ("Turn left.", ["Turn the lap."], False),
    ],
)
def test_a_stop_word_that_hearing_was_shown_is_heard_without_it_too(said, without, is_parroted):
    alone = [likely(text, math.exp(-0.6 * at)) for at, text in enumerate(without)]

    assert stop_word_parroted(said, ("stop", "halt"), alone) is is_parroted


def test_what_is_only_heard_without_being_shown_needs_a_yes():
    said = transcript_of([segment("Go left.", -0.01)], 1.0, "", only_alone)

    assert (said.text, said.confidence < HEARD_FROM) == ("Go left.", True)
