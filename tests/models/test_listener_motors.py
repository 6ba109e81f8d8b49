"""The robot's own motors: alone they are no utterance, and speech over them ends as in quiet."""

import numpy as np
import pytest
from listener_rig import frames, in_a_room, loud, says_espeak, says_piper

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.utterance_end import Endpointer, SpeechEnded
from edgevox.voice.vad import open_vad
from training.acoustics import Half
from training.acoustics.noises import ITS_OWN, noise

LEVEL = 0.05
LATE_S = 0.5


def over_at(sound):
    """When each utterance in it is over, in seconds; infinite for one that has no end."""
    vad, endpointer, found = open_vad(), Endpointer(), []
    for frame in frames(sound):
        signal = endpointer.push(frame, vad.probability(frame.samples))
        if isinstance(signal, SpeechEnded):
            found.append(frame.end_s)
    return [*found, np.inf] if endpointer.speaking else found


def motors(kind, samples, seed):
    made = noise(kind, samples / RATE_HZ + 0.1, seed, Half.HELD_OUT)[:samples]
    return loud((1000 * made).astype(np.int16), LEVEL)


@pytest.mark.parametrize("kind", ITS_OWN)
def test_a_robot_that_begins_to_move_hears_no_utterance(kind):
    assert over_at(in_a_room(motors(kind, 20 * RATE_HZ, 1))) == []


@pytest.mark.parametrize("kind", ["steps", "fans"])
@pytest.mark.parametrize("says", [says_espeak, says_piper])
def test_a_command_that_is_as_loud_as_they_are_ends_about_when_it_does_in_quiet(kind, says):
    quiet = in_a_room(loud(says("Please drive to the living room."), LEVEL))
    beside = quiet.astype(np.int32) + motors(kind, quiet.size, 2)
    (wanted,), (found,) = over_at(quiet), over_at(np.clip(beside, -32768, 32767).astype(np.int16))
    assert abs(found - wanted) < LATE_S
