"""The floor of what is heard, and by how much a voice stands out of it, on known levels."""

import numpy as np
import pytest

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ
from edgevox.voice.noise_floor import LEAST_FRAMES, SILENT_DB, WINDOW_S, NoiseFloor, speech_db

VOICE, NONE = 0.9, 0.05


def push(noise, level_db, probability, frames=1):
    sample = round(32768 * 10 ** (level_db / 20))
    for _ in range(frames):
        noise.push(np.full(FRAME_SAMPLES, sample, np.int16), probability)


def test_what_is_said_stands_out_of_the_noise_around_it():
    noise = NoiseFloor()
    push(noise, -60.0, NONE, 50)
    push(noise, -20.0, VOICE, 30)

    assert noise.floor_db == pytest.approx(-60.0, abs=0.2)
    assert noise.stands_out_db == pytest.approx(40.0, abs=0.2)


def test_noise_that_breaks_off_is_noise():
    noise = NoiseFloor()
    for _ in range(10):
        push(noise, -30.0, NONE, 8)
        push(noise, -80.0, NONE, 12)
    push(noise, -20.0, VOICE, 30)

    assert noise.stands_out_db == pytest.approx(10.0, abs=0.2)


def test_where_voices_never_end_nothing_is_known():
    noise = NoiseFloor()
    push(noise, -60.0, NONE, LEAST_FRAMES - 1)
    push(noise, -20.0, VOICE, 200)

    assert noise.floor_db is None
    assert noise.stands_out_db is None


def test_what_was_long_ago_counts_no_more():
    noise = NoiseFloor()
    push(noise, -60.0, NONE, 100)
    push(noise, -30.0, NONE, round(WINDOW_S / FRAME_S))

    assert noise.floor_db == pytest.approx(-30.0, abs=0.2)


def test_what_was_forgotten_counts_no_more():
    noise = NoiseFloor()
    push(noise, -60.0, NONE, 100)

    noise.reset()

    assert noise.stands_out_db is None


def test_silence_is_as_quiet_as_16_bits_are():
    noise = NoiseFloor()

    assert noise.push(np.zeros(FRAME_SAMPLES, np.int16), NONE) == SILENT_DB


def test_the_level_of_speech_is_that_of_its_louder_half():
    loud, quiet = np.full(RATE_HZ, 3277, np.int16), np.full(RATE_HZ // 2, 30, np.int16)

    assert speech_db(loud) == pytest.approx(-20.0, abs=0.1)
    assert speech_db(np.concatenate([quiet, loud, quiet])) == pytest.approx(-20.0, abs=0.1)
    assert speech_db(np.zeros(0, np.int16)) == SILENT_DB
