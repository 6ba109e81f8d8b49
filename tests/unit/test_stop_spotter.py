"""The stop word spotter: what it computes a frame at a time, and what it never takes for a word."""

import numpy as np
import pytest

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ
from edgevox.voice.stop_features import BANDS, ROWS, StopFeatures, features_of
from edgevox.voice.stop_network import StopNetwork, read_weights
from edgevox.voice.stop_spotter import StopSpotter, open_stop_spotter


def sound(seconds: float, level: float = 300.0) -> np.ndarray:
    """Hiss, in whole frames."""
    n = int(seconds * RATE_HZ) // FRAME_SAMPLES * FRAME_SAMPLES
    return np.random.default_rng(5).normal(0, level, n).astype(np.int16)


def frames(samples: np.ndarray) -> list[np.ndarray]:
    return [*samples.reshape(-1, FRAME_SAMPLES)]


def likelihoods(spotter: StopSpotter, samples: np.ndarray) -> list[float]:
    found = []
    for frame in frames(samples):
        spotter.heard(frame)
        found.append(spotter.likelihood)
    return found


def test_features_of_a_stream_are_those_of_all_of_it_at_once():
    whole, stream = sound(2.0), StopFeatures()

    streamed = np.concatenate([stream.push(frame) for frame in frames(whole)])

    assert streamed.shape == (len(frames(whole)) * ROWS, BANDS)
    np.testing.assert_allclose(streamed, features_of(whole), atol=1e-4)


def test_a_hum_that_goes_on_vanishes_from_the_features():
    t = np.arange(4 * RATE_HZ) / RATE_HZ
    hum = (8000 * np.sin(2 * np.pi * 500 * t)).astype(np.int16)

    found = features_of(hum)

    assert found[-1].max() < 0.6
    np.testing.assert_allclose(found[-40], found[-1], atol=0.15)


def test_the_features_hardly_change_with_loudness():
    np.testing.assert_allclose(
        features_of(sound(1.0, 300.0)), features_of(sound(1.0, 3000.0)), rtol=0.1, atol=0.1
    )


def test_the_network_says_the_same_of_a_stream_and_of_all_of_it_at_once():
    weights = read_weights()
    rows = features_of(sound(2.0))

    stream = StopNetwork(weights)
    streamed = np.concatenate([stream.push(rows[n : n + ROWS]) for n in range(0, len(rows), ROWS)])

    np.testing.assert_allclose(streamed, StopNetwork(weights).push(rows), atol=1e-4)


def test_likelihoods_add_up_to_one():
    np.testing.assert_allclose(
        StopNetwork(read_weights()).push(features_of(sound(1.0))).sum(1), 1, atol=1e-5
    )


def test_what_was_forgotten_leaves_no_trace():
    used, new = open_stop_spotter(), open_stop_spotter()
    likelihoods(used, sound(1.5, 4000.0))

    used.forget()

    assert likelihoods(used, sound(1.0)) == pytest.approx(likelihoods(new, sound(1.0)), abs=1e-6)


@pytest.mark.parametrize("level", [0.0, 10.0, 300.0, 20_000.0])
def test_silence_and_hiss_stop_nothing(level):
    spotter = open_stop_spotter()

    assert not any(spotter.heard(frame) for frame in frames(sound(20.0, level)))


def test_a_hum_and_a_click_stop_nothing():
    t = np.arange(20 * RATE_HZ) / RATE_HZ
    hum = sum(2000 * np.sin(2 * np.pi * 90 * k * t) / k for k in range(1, 20))
    hum[:: RATE_HZ // 2] = 30_000
    spotter = open_stop_spotter()

    assert not any(spotter.heard(frame) for frame in frames(hum.astype(np.int16)[: 625 * 512]))


def test_with_a_threshold_of_nothing_one_word_is_one_stop():
    spotter = StopSpotter(read_weights(), threshold=0.0)

    found = [spotter.heard(frame) for frame in frames(sound(1.28))]

    assert found[0]
    assert 1 < sum(found) < 4
