"""Who speaks where something of the robot's own voice is left in what is heard, by two detectors
that are told what to say.
"""

import numpy as np
import pytest

from edgevox.voice.audio import FRAME_SAMPLES
from edgevox.voice.echo.canceller import HINTED_FRAMES, FoundVoice, VoiceOverEcho
from edgevox.voice.echo.gate import Unechoed


class Ears:
    """Finds as much of a voice in a frame as its first sample says, in hundredths."""

    any_voice = 0.0

    def __init__(self):
        self.others, self.resets = [], 0

    def probability(self, samples):
        return samples[0] / 100

    def reset(self):
        self.resets += 1

    def another(self):
        self.others.append(Ears())
        return self.others[-1]


def frame(hundredths):
    return np.full(FRAME_SAMPLES, hundredths, np.int16)


def sound(voice, words, **more):
    return Unechoed(frame(words), frame(voice), frame(words), **more)


@pytest.fixture
def ears():
    return Ears()


@pytest.fixture
def voices(ears):
    return VoiceOverEcho(ears)


def test_where_nothing_is_cancelled_there_is_one_detector(voices, ears):
    assert voices.of(sound(30, 90)) == FoundVoice(0.3, surmised=False)
    assert not ears.others


def test_a_voice_in_what_is_left_is_surmised_until_it_is_known_to_be_somebodys(voices):
    assert voices.of(sound(30, 90, cancelled=True)) == FoundVoice(0.3, surmised=True)
    assert voices.of(sound(30, 90, cancelled=True, somebody=True)) == FoundVoice(0.9, surmised=True)
    assert voices.of(sound(30, 20, cancelled=True, somebody=True)) == FoundVoice(
        0.3, surmised=False
    )


def test_a_voice_that_the_suppressed_sound_never_hints_at_is_the_robots_own_beside_a_motor(voices):
    def heard(suppressed):
        return voices.of(
            sound(90, 90, cancelled=True, somebody=True, suppressed=frame(suppressed))
        ).probability

    assert [heard(2), heard(9)] == [0.02, 0.09]
    assert heard(10) == 0.9
    assert [heard(0) for _ in range(HINTED_FRAMES)] == [0.9] * (HINTED_FRAMES - 1) + [0.0]


def test_the_second_detector_begins_anew_after_frames_that_it_did_not_hear(voices, ears):
    for cancelled in (True, True, False, True):
        voices.of(sound(0, 0, cancelled=cancelled))
    voices.reset()
    voices.of(sound(0, 0, cancelled=True))

    second, _ = ears.others
    assert second.resets == 3
    assert ears.resets == 1
