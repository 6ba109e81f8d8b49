import pytest

from edgevox.voice.stt.speech_to_text import Segment, plausible, words_of
from edgevox.voice.utterance_end import SpeechEnded
from edgevox.voice.wake.gate import FOLLOW_S, SHORT_S, WakeDecision, WakeGate


def said(began_s, ended_s):
    return SpeechEnded(samples=None, began_s=began_s, ended_s=ended_s)


@pytest.mark.parametrize(
    ("segment", "seconds", "counts"),
    [
        (Segment(" Go to the kitchen.", 0.02, -0.02, 0.8), 1.5, True),
        (Segment(" Hey, Darvie's go to the kitchen.", 0.03, -0.89, 0.8), 2.0, True),
        (Segment(" Where are you?", 0.45, -0.26, 0.7), 1.0, True),
        (Segment(" Stop.", 0.32, -0.39, 0.4), 0.5, True),
        (Segment(" y minus 1.5, y minus 1.5, y minus 1.5", 0.1, -0.13, 14.2), 1.5, False),
        (Segment(" Go to x 2.5.", 0.79, -0.82, 0.6), 1.5, False),
        (Segment(" Halt!", 0.47, -0.97, 0.4), 1.5, False),
        (Segment(" 1.", 0.3, -1.58, 0.2), 1.5, False),
        (Segment(" you", 0.1, -0.3, 0.3), 1.0, False),
        (Segment(" Thank you.", 0.05, -0.3, 0.5), 0.8, True),
        (Segment(" Thank you.", 0.5, -0.3, 0.5), 0.8, False),
        (Segment(" Thanks for watching!", 0.1, -0.3, 0.5), 9.0, False),
        (Segment(" ...", 0.1, -0.3, 0.5), 1.0, False),
    ],
)
def test_words_that_whisper_makes_of_noise_do_not_count(segment, seconds, counts):
    assert plausible(segment, seconds) is counts


def test_remarks_are_not_words():
    assert words_of(" [music] go  left (laughs)") == "go left"
    assert words_of(" *sighs*") == ""


def test_who_never_said_the_wake_word_is_only_understood_when_short():
    wake_gate = WakeGate()

    assert wake_gate.judge(said(10.0, 10.0 + SHORT_S - 0.1)) is WakeDecision.UNADDRESSED
    assert wake_gate.judge(said(20.0, 20.0 + SHORT_S + 0.1)) is WakeDecision.IGNORE


def test_the_wake_word_counts_once():
    wake_gate = WakeGate()
    wake_gate.wake(10.5)

    assert wake_gate.judge(said(10.0, 13.0)) is WakeDecision.TAKE
    wake_gate.take(said(10.0, 13.0))
    assert wake_gate.judge(said(14.0, 15.0)) is WakeDecision.UNADDRESSED


def test_the_wake_word_counts_for_what_an_utterance_goes_on_with():
    wake_gate = WakeGate()
    wake_gate.wake(10.5)
    wake_gate.take(said(10.0, 13.0))

    assert wake_gate.judge(said(10.0, 15.0)) is WakeDecision.TAKE
    assert wake_gate.phrase_from(said(10.0, 15.0)) == 0.0
    assert wake_gate.judge(said(13.7, 15.0)) is WakeDecision.UNADDRESSED


def test_the_wake_word_alone_leaves_the_attention_on_what_comes_next():
    wake_gate = WakeGate()
    wake_gate.wake(10.8)

    assert wake_gate.judge(said(10.0, 10.9)) is WakeDecision.IGNORE
    assert wake_gate.judge(said(12.0, 15.0)) is WakeDecision.TAKE


def test_attention_ends():
    wake_gate = WakeGate()
    wake_gate.wake(10.0)

    assert wake_gate.judge(said(10.1 + FOLLOW_S, 14.0 + FOLLOW_S)) is WakeDecision.IGNORE


def test_what_was_said_long_before_the_wake_word_is_left_out():
    wake_gate = WakeGate()
    wake_gate.wake(15.0)

    assert wake_gate.phrase_from(said(10.0, 17.0)) == pytest.approx(3.7)
    assert wake_gate.phrase_from(said(14.2, 17.0)) == 0.0
    assert wake_gate.phrase_from(said(16.0, 17.0)) is None
