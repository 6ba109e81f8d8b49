"""The echo gate's threshold, measured: the robot's voice (Piper) comes back through rooms of -6 to
-30 dB, later and with reverberation, while a person (espeak-ng) speaks over it or nobody does.
"""

import numpy as np
import pytest
from listener_rig import frames, loud, room_echo, says_espeak, says_piper, silence

from edgevox.voice.audio import RATE_HZ, rms
from edgevox.voice.echo.gate import EchoGate
from edgevox.voice.utterance_end import Endpointer, SpeechBegan
from edgevox.voice.vad import open_vad

ROBOT_LEVEL = 0.1
ROOMS_DB = (-6, -12, -18, -24, -30)
SPOKEN_OVER_S = 6.0


@pytest.fixture(scope="module")
def answer():
    """12 s and more of the robot's voice."""
    sentences = (
        "I am going to the kitchen now, and I will tell you when I have arrived.",
        "My battery is at eighty five percent, which is enough for the next two hours.",
        "There is a chair in front of me, so I take another way around the table.",
    )
    return loud(np.concatenate([says_piper(s) for s in sentences]), ROBOT_LEVEL)


def beginnings(played, heard, *, shut=True):
    """When speech begins, by what is heard while something else is played."""
    levels = iter([rms(frame.samples) for frame in frames(played)])
    gate, vad, endpointer = (
        EchoGate(lambda: next(levels), shut=shut),
        open_vad(),
        Endpointer(),
    )
    found = []
    for frame in frames(heard):
        samples = frame.samples if gate.passes(frame.samples) else np.zeros_like(frame.samples)
        signal = endpointer.push(frame, vad.probability(samples))
        if isinstance(signal, SpeechBegan):
            found.append(frame.end_s)
    return found


def mixed(echo, person_level):
    person = loud(says_espeak("no no no, stop right there, please"), person_level)
    heard = echo + silence(echo.size / RATE_HZ)[: echo.size]
    start = int(SPOKEN_OVER_S * RATE_HZ)
    heard[start : start + person.size] += person
    return heard


@pytest.mark.long
@pytest.mark.parametrize("gain_db", ROOMS_DB)
@pytest.mark.parametrize("delay_s", [0.02, 0.15])
def test_the_robot_does_not_hear_itself(answer, gain_db, delay_s):
    echo = room_echo(answer, gain_db, delay_s)

    assert beginnings(answer, echo + silence(answer.size / RATE_HZ)[: echo.size]) == []


def test_without_the_gate_it_would(answer):
    assert beginnings(answer, room_echo(answer, -12), shut=False)


@pytest.mark.parametrize(
    ("gain_db", "person_level"),
    [(-6, 0.3), (-12, 0.1), (-18, 0.1), (-24, 0.05), (-30, 0.05)],
)
def test_a_person_who_speaks_over_it_is_heard(answer, gain_db, person_level):
    found = beginnings(answer, mixed(room_echo(answer, gain_db), person_level))

    assert found
    assert 0 < found[0] - SPOKEN_OVER_S < 0.6
