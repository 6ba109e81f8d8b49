"""Who speaks among others is heard by itself: what they say begins and ends, others say nothing."""

import numpy as np
from listener_rig import frames, loud, says_espeak, silence

from edgevox.voice.audio import FRAME_S, RATE_HZ
from edgevox.voice.utterance_end import Endpointer, SpeechEnded
from edgevox.voice.vad import open_vad

TALK = (
    "I have left the other box in the hall, so bring it along when you come back. ",
    "We were at the market in the morning and bought apples, bread and a little cheese. ",
    "Could you tell me again when the next train is going to leave from here? ",
    "She said that nobody had seen the new machine before it was put to work. ",
    "It takes about an hour by car, but on a Sunday it may well be less than that. ",
    "The children are playing outside and will not be back before the evening. ",
)
BEFORE_S, AFTER_S = 6.0, 3.0
LEVEL = 0.05


def canteen(size):
    """Many people at once."""
    voices = [
        np.resize(says_espeak(text), size + 4_000 * n)[4_000 * n :] for n, text in enumerate(TALK)
    ]
    return loud(np.sum(np.asarray(voices, np.float64), axis=0) / len(TALK), LEVEL / 4)


def ended(sound, endpointer):
    vad = open_vad()
    for frame in frames(sound):
        signal = endpointer.push(frame, vad.probability(frame.samples))
        if isinstance(signal, SpeechEnded):
            yield signal


def test_a_command_among_many_voices_begins_and_ends():
    command = loud(says_espeak("Go to the kitchen, please."), LEVEL)
    end_s = BEFORE_S + command.size / RATE_HZ
    said = np.concatenate([silence(BEFORE_S), command, silence(AFTER_S)]).astype(np.int32)
    sound = (said + canteen(said.size)).astype(np.int16)
    (its,) = [one for one in ended(sound, Endpointer()) if one.ended_s > BEFORE_S + 0.5]
    assert BEFORE_S - 0.5 < its.began_s < BEFORE_S + 0.5
    assert end_s - 0.5 < its.ended_s < end_s + 0.5


def test_many_voices_alone_are_nobody_who_speaks_once_they_are_known():
    endpointer = Endpointer()
    said = list(ended(canteen(int(12 * RATE_HZ)), endpointer))
    assert not endpointer.speaking
    assert [one for one in said if one.began_s > 2.0] == []


def test_another_detector_like_it_hears_for_itself():
    sound = frames(loud(says_espeak("Go to the kitchen, please."), LEVEL))
    one, alone = open_vad(), open_vad()
    other = one.another()

    found, silent = [], []
    for frame in sound:
        silent.append(other.probability(silence(FRAME_S)))
        found.append(one.probability(frame.samples))
        assert found[-1] == alone.probability(frame.samples)
    assert max(found) > 0.5 > max(silent)
