import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Frame
from edgevox.voice.utterance_end import (
    END_S,
    MAX_S,
    ONSET_FRAMES,
    PRE_ROLL_S,
    SURMISED_ONSET_FRAMES,
    SURMISED_S,
    Endpointer,
    SpeechBegan,
    SpeechEnded,
    SpeechPaused,
)

END_FRAMES = round(END_S / FRAME_S)
PRE_FRAMES = round(PRE_ROLL_S / FRAME_S)
SURMISED_FRAMES = round(SURMISED_S / FRAME_S)
MAX_SAMPLES = int(MAX_S / FRAME_S) * FRAME_SAMPLES


def run(probabilities, endpointer=None, *, pauses=False, surmised=()):
    """What came of it: (number of the frame, signal); each frame is filled with its number.

    With `pauses`, those too; `surmised` has the numbers of frames.
    """
    endpointer = endpointer or Endpointer()
    found = []
    for number, probability in enumerate(probabilities):
        samples = np.full(FRAME_SAMPLES, number % 30000, np.int16)
        frame = Frame(samples, (number + 1) * FRAME_S)
        signal = endpointer.push(frame, probability, surmised=number in surmised)
        if signal and (pauses or not isinstance(signal, SpeechPaused)):
            found.append((number, signal))
    return found


def test_an_utterance_has_the_times_of_its_first_and_last_voiced_sample():
    found = run([0.0] * 20 + [0.9] * 30 + [0.0] * 40)

    (began_at, began), (ended_at, ended) = found
    assert began == SpeechBegan(pytest.approx(20 * FRAME_S))
    assert began_at == 20 + ONSET_FRAMES - 1
    assert ended.began_s == pytest.approx(20 * FRAME_S)
    assert ended.ended_s == pytest.approx(50 * FRAME_S)
    assert ended_at == 50 + END_FRAMES - 1
    assert not ended.cut


@pytest.mark.parametrize(("surmised", "begins"), [(range(18, 25), True), (range(24, 27), False)])
def test_few_voiced_frames_begin_speech_only_in_a_surmised_voice(surmised, begins):
    voiced = [0.9] * SURMISED_ONSET_FRAMES

    found = run([0.0] * 22 + voiced + [0.0] * 40, surmised=surmised)

    assert bool(found) is begins


def test_the_sound_before_the_first_voiced_frame_is_kept():
    (_, _), (_, ended) = run([0.0] * 20 + [0.9] * 30 + [0.0] * 40)

    assert ended.samples[0] == 20 - PRE_FRAMES


@pytest.mark.parametrize(
    ("surmised", "begins"),
    [
        (range(30, 40), 30),
        ((30, *range(34, 40)), 30),
        ((30, *range(35, 40)), 35),
        (range(40), 40 - SURMISED_FRAMES),
        (range(20, 30), 40),
        ((), 40),
    ],
    ids=["at once before", "with a gap", "a gap too long", "too long ago", "another", "none"],
)
def test_speech_begins_where_it_was_surmised_once_it_is_known(surmised, begins):
    (_, began), (_, ended) = run([0.0] * 40 + [0.9] * 30 + [0.0] * 40, surmised=surmised)

    assert began.began_s == pytest.approx(begins * FRAME_S)
    assert ended.samples[0] == max(0, begins - PRE_FRAMES)


def test_what_is_only_surmised_is_no_speech():
    assert run([0.0] * 60, surmised=range(60)) == []


def test_a_click_is_no_speech():
    assert run([0.0] * 20 + [1.0] * (ONSET_FRAMES - 1) + [0.0] * 60) == []


def test_a_pause_tells_once_what_the_end_will_give_if_nothing_more_is_said():
    found = run([0.9] * 20 + [0.0] * 40, pauses=True)

    assert [type(signal) for _, signal in found] == [SpeechBegan, SpeechPaused, SpeechEnded]
    (_, _), (paused_at, paused), (ended_at, ended) = found
    assert np.array_equal(paused.samples, ended.samples)
    assert paused.ended_s == ended.ended_s
    assert (ended_at - paused_at) * FRAME_S >= 0.3


def test_a_pause_within_a_sentence_does_not_end_it():
    pause = [0.0] * (END_FRAMES - 1)

    found = run([0.9] * 20 + pause + [0.9] * 20 + [0.0] * 40)

    assert [type(signal) for _, signal in found] == [SpeechBegan, SpeechEnded]


def test_a_murmur_between_the_thresholds_does_not_bridge_a_pause_for_ever():
    found = run([0.9] * 20 + [0.0] * 3 + [0.45] * 100)

    assert isinstance(found[-1][1], SpeechEnded)


def test_who_speaks_for_a_minute_is_heard_in_pieces_without_a_gap():
    found = run([0.9] * round(60 / FRAME_S) + [0.0] * 40)

    pieces = [signal for _, signal in found if isinstance(signal, SpeechEnded)]
    numbers = np.concatenate([piece.samples[::FRAME_SAMPLES] for piece in pieces])
    assert pieces[0].cut
    assert all(piece.samples.size <= MAX_SAMPLES for piece in pieces)
    assert np.array_equal(numbers, np.arange(numbers.size))


def test_silence_after_a_cut_is_not_an_utterance():
    frames = int(MAX_S / FRAME_S)

    found = run([0.9] * frames + [0.0] * 100)

    assert sum(isinstance(signal, SpeechEnded) for _, signal in found) == 1


def test_the_end_of_the_sound_ends_what_is_said():
    endpointer = Endpointer()
    run([0.9] * 20, endpointer)

    ended = endpointer.finish()

    assert ended is not None
    assert ended.cut
    assert endpointer.finish() is None


def test_forgetting_drops_what_has_begun():
    endpointer = Endpointer()
    run([0.9] * 20, endpointer)

    endpointer.reset()

    assert run([0.0] * 40, endpointer) == []
    assert endpointer.finish() is None


@given(st.lists(st.floats(0, 1), max_size=300), st.floats(0.1, 1.0), st.floats(1.0, 4.0))
def test_whatever_is_heard_beginnings_and_ends_alternate_and_utterances_are_bounded(
    probabilities, end_s, max_s
):
    endpointer = Endpointer(end_s=end_s, max_s=max_s)

    found = run(probabilities, endpointer)

    before = None
    last_s = 0.0
    for number, signal in found:
        if isinstance(signal, SpeechBegan):
            assert not isinstance(before, SpeechBegan)
        else:
            goes_on = isinstance(before, SpeechEnded) and before.cut
            assert isinstance(before, SpeechBegan) or goes_on
            assert 0 < signal.samples.size <= int(max_s / FRAME_S) * FRAME_SAMPLES
            assert last_s <= signal.began_s < signal.ended_s <= (number + 1) * FRAME_S + 1e-9
            last_s = signal.ended_s
        before = signal
