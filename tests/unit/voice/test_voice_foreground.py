"""Who speaks to the robot is told from voices that are always there, by being louder."""

import numpy as np
import pytest

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES
from edgevox.voice.vad import ForegroundVad


class Says:
    """A detector that says what a test wants."""

    def __init__(self) -> None:
        self.says = 0.0
        self.resets = 0

    @property
    def any_voice(self):
        return self.says

    def probability(self, samples):
        return self.says

    def reset(self):
        self.resets += 1


@pytest.fixture
def hear():
    """Hears so many seconds at a level of dB of full scale, in which the detector says that."""
    rng, inner = np.random.default_rng(5), Says()
    vad = ForegroundVad(inner)

    def heard(level_db, says, seconds):
        inner.says = says
        amplitude = 32768 * 10 ** (level_db / 20)
        return [
            vad.probability(rng.normal(0, amplitude, FRAME_SAMPLES).astype(np.int16))
            for _ in range(round(seconds / FRAME_S))
        ]

    heard.vad, heard.inner = vad, inner
    return heard


def test_in_quiet_it_says_what_the_detector_says_however_softly_one_ends(hear):
    assert set(hear(-80, 0.02, 4)) == {0.02}
    for _ in range(6):
        assert set(hear(-25, 0.9, 1.5)) == {0.9}
        assert set(hear(-45, 0.8, 0.3)) == {0.8}
        assert set(hear(-70, 0.1, 0.3)) == {0.1}


def test_in_noise_it_says_what_the_detector_says_though_no_louder_than_the_noise(hear):
    assert set(hear(-30, 0.1, 4)) == {0.1}
    assert set(hear(-30, 0.7, 2)) == {0.7}


def test_voices_that_are_always_there_are_none_and_who_is_louder_is_one(hear):
    hear(-40, 0.9, 4)
    assert set(hear(-40, 0.9, 2)) == {0.0}
    near = hear(-34, 0.9, 1)
    assert near[-20:] == [0.9] * 20
    assert hear(-40, 0.9, 1)[-20:] == [0.0] * 20


def test_who_speaks_over_others_for_seconds_stays_one(hear):
    hear(-40, 0.9, 4)
    assert [hear(level, 0.9, 0.5)[-1] for level in (-32, -42, -32, -42, -32, -42, -32)][::2] == (
        [0.9] * 4
    )


def test_before_a_second_was_heard_nothing_is_behind(hear):
    assert set(hear(-40, 0.9, 0.9)) == {0.9}


def test_once_the_others_are_gone_who_speaks_softly_is_heard_again(hear):
    hear(-40, 0.9, 8)
    hear(-80, 0.01, 2)
    assert hear(-46, 0.9, 1)[-1] == 0.9


def test_what_was_before_is_forgotten_when_it_does_not_follow(hear):
    hear(-40, 0.9, 4)
    hear.vad.reset()
    assert hear.inner.resets == 2
    assert set(hear(-40, 0.9, 0.9)) == {0.9}
