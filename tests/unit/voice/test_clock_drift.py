"""What of a sound is another one's echo, where clocks drift and a loudspeaker distorts."""

import numpy as np
import pytest
from simulated_echo import decibels, room, voice

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.echo import filter as adaptive_filter
from edgevox.voice.echo.filter import BLOCK_SAMPLES, MOST_PPM, AdaptiveFilter, ClockDrift

pytestmark = pytest.mark.long

SECONDS = 14.0
LATER = slice(int(8 * RATE_HZ) // BLOCK_SAMPLES * BLOCK_SAMPLES, None)


@pytest.fixture(scope="module")
def played():
    return voice(SECONDS, seed=1)


def drifted(sound, ppm):
    """The same, by a clock that runs faster by so much."""
    at = np.arange(sound.size) * (1 + ppm * 1e-6)
    fine = np.fft.irfft(np.fft.rfft(sound), 8 * sound.size) * 8
    return np.interp(8 * at, np.arange(fine.size), fine)


def left(filter_, heard, played):
    whole = heard.size // BLOCK_SAMPLES * BLOCK_SAMPLES
    return filter_.push(heard[:whole].astype(np.float32), played[:whole].astype(np.float32))


@pytest.mark.parametrize(
    "ppm", [-120.0, *(pytest.param(one, marks=pytest.mark.long) for one in (0.0, 60.0))]
)
def test_the_drift_of_the_clocks_is_found_and_the_echo_taken_out_all_the_same(played, ppm):
    filter_, heard = AdaptiveFilter(), room(drifted(played, ppm))

    found = left(filter_, heard, played)

    assert filter_.drift_ppm == pytest.approx(ppm, abs=15)
    assert decibels(heard[LATER][: found[LATER].size], found[LATER]) > 20


def test_more_is_taken_out_of_what_a_loudspeaker_distorts(played, monkeypatch):
    heard = room(np.tanh(8 * played + 0.2) / 8)

    found = left(AdaptiveFilter(), heard, played)

    monkeypatch.setattr(adaptive_filter, "distorted", lambda sound: np.stack([sound]))
    linear = left(AdaptiveFilter(), heard, played)
    assert decibels(linear[LATER], found[LATER]) > 2


def test_a_person_is_left_as_they_are(played):
    person = voice(SECONDS, seed=5, level=0.03)
    person[: LATER.start] = 0.0

    found = left(AdaptiveFilter(), room(played) + person, played)

    assert decibels(person[LATER][: found[LATER].size], found[LATER] - person[LATER]) > 3


def test_where_nothing_is_heard_of_what_is_played_no_drift_is_found(played):
    filter_ = AdaptiveFilter()

    left(filter_, np.random.default_rng(1).normal(0, 0.01, played.size), played)

    assert abs(filter_.drift_ppm) < 60


def test_no_clock_is_believed_to_be_worse_than_any_is():
    drift = ClockDrift(BLOCK_SAMPLES)
    way = np.ones((1, BLOCK_SAMPLES + 1), np.complex64)

    for _ in range(1_000):
        drift.follow(way, 1j * way, heard=1.0, left=0.0)

    assert drift.ppm == MOST_PPM
    turns = drift.turns()
    assert np.angle(turns[-1]) == pytest.approx(np.pi * MOST_PPM * 1e-6 * BLOCK_SAMPLES, rel=1e-3)
    assert np.abs(turns) == pytest.approx(1.0)
