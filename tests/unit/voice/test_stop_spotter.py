"""The stop word spotter: what it looks at and when, and what it makes of what it is told."""

from pathlib import Path

import numpy as np
import pytest

from edgevox.core.languages import LANGUAGES
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ
from edgevox.voice.stop_spotter import network
from edgevox.voice.stop_spotter import spotter as stop_spotter
from edgevox.voice.stop_spotter.network import (
    BANDS,
    CHANNELS,
    ENCODER,
    SAMPLES,
    STEPS,
    WEIGHTS_FILE,
    EncoderNotLoaded,
    StopEncoder,
    bands_of,
    likelihoods,
    read_weights,
    weights_of,
)
from edgevox.voice.stop_spotter.spotter import (
    LEAST_ODDS,
    LOOKED_AT,
    LOOKS_EVERY,
    MOST_ASKED,
    NOISY_DB,
    QUIET_DB,
    QUIET_TIMES,
    REST_S,
    SMOOTHED_LOOKS,
    StopJudge,
    StopSpotter,
)
from edgevox.voice.stt.adapter import DOWN, UP
from edgevox.voice.word_detection import AWAKE_S

NOTHING = np.array([1.0, 0.0, 0.0, 0.0], np.float32)
HALT = np.array([0.04, 0.01, 0.94, 0.01], np.float32)
MAYBE = np.array([0.4, 0.1, 0.4, 0.1], np.float32)
LIKELY = np.array([0.1, 0.0, 0.9, 0.0], np.float32)
HARDLY = np.array([0.7, 0.0, 0.3, 0.0], np.float32)
WEIGHTS = Path(network.__file__).with_name(WEIGHTS_FILE)
LOOK_S = LOOKS_EVERY * FRAME_SAMPLES / RATE_HZ


def hiss(n: int, level: float = 300.0) -> np.ndarray:
    return np.random.default_rng(5).normal(0, level, n).astype(np.int16)


def encoded(sounds: int) -> np.ndarray:
    """Stands for what the encoder makes of so many."""
    return np.random.default_rng(7).normal(0, 3, (sounds, STEPS, CHANNELS)).astype(np.float32)


class Encoder:
    """Keeps what it was asked to look at, and makes the same of all."""

    def __init__(self):
        self.seen = []

    def of(self, sounds):
        self.seen += [sound.copy() for sound in sounds]
        return encoded(len(sounds))


def test_its_encoder_is_what_recognises_english_and_its_words_stop_in_every_language():
    assert LANGUAGES["en"].stt_model == ENCODER
    assert set(read_weights().words[1:]) <= set(LANGUAGES["en"].stop.anywhere)


def test_what_is_looked_at_does_not_change_with_loudness():
    usual = bands_of(hiss(SAMPLES))

    assert usual.shape == (BANDS, 2 * STEPS)
    np.testing.assert_allclose(bands_of(20 * hiss(SAMPLES)), usual, atol=1e-3)


@pytest.mark.parametrize(
    "sound", [np.zeros(SAMPLES, np.int16), np.full(SAMPLES, -32_768, np.int16)]
)
def test_silence_and_the_loudest_are_numbers_too(sound):
    assert np.all(np.isfinite(bands_of(sound)))


def test_likelihoods_add_up_to_one():
    found = likelihoods(read_weights(), encoded(3))

    assert found.shape == (3, len(read_weights().words))
    np.testing.assert_allclose(found.sum(1), 1, atol=1e-5)


def test_each_sound_is_judged_by_itself():
    weights, some = read_weights(), encoded(3)

    np.testing.assert_allclose(
        likelihoods(weights, some)[1], likelihoods(weights, some[1:2])[0], atol=1e-5
    )


def test_what_is_added_to_the_encoder_is_a_product_of_two_narrow_matrices():
    up, down = np.ones((4, 2), np.float16), np.full((2, 3), 0.25, np.float16)
    with np.load(WEIGHTS) as data:
        held = {name: data[name] for name in data if not name.endswith((UP, DOWN))}

    added = weights_of(held | {f"conv1{UP}": up, f"conv1{DOWN}": down}).added

    assert list(added) == ["conv1"]
    np.testing.assert_array_equal(added["conv1"].numbers, np.full(12, 0.5, np.float32))
    assert weights_of(held).added == {}


def test_an_encoder_that_cannot_be_loaded_is_not_tried_again(tmp_path):
    encoder, sound = StopEncoder(tmp_path, {}), np.zeros(SAMPLES, np.int16)
    with pytest.raises(EncoderNotLoaded, match=r"model\.bin"):
        encoder.of([sound])
    tmp_path.rmdir()

    with pytest.raises(EncoderNotLoaded, match=r"model\.bin"):
        encoder.of([sound])


def test_it_looks_at_the_last_of_the_sound_every_so_often():
    encoder, sound = Encoder(), hiss(50 * FRAME_SAMPLES)
    spotter = StopSpotter(encoder, read_weights())

    for frame in sound.reshape(-1, FRAME_SAMPLES):
        spotter.heard(frame, 1.0)

    assert len(encoder.seen) == 50 // LOOKS_EVERY
    last = 50 // LOOKS_EVERY * LOOKS_EVERY * FRAME_SAMPLES
    np.testing.assert_array_equal(encoder.seen[-1], sound[last - SAMPLES : last])


def test_what_was_forgotten_is_not_looked_at():
    encoder = Encoder()
    spotter = StopSpotter(encoder, read_weights())
    for frame in hiss(20 * FRAME_SAMPLES).reshape(-1, FRAME_SAMPLES):
        spotter.heard(frame, 1.0)
    encoder.seen.clear()

    spotter.forget()
    for _ in range(LOOKS_EVERY):
        spotter.heard(np.zeros(FRAME_SAMPLES, np.int16), 1.0)

    assert len(encoder.seen) == 1
    assert not encoder.seen[0].any()


def test_it_sleeps_while_nobody_speaks_and_sees_what_it_slept_through():
    encoder, sound = Encoder(), hiss(60 * FRAME_SAMPLES).reshape(-1, FRAME_SAMPLES)
    spotter = StopSpotter(encoder, read_weights())

    for frame in sound[:58]:
        spotter.heard(frame, 0.01)
    assert not encoder.seen
    for frame in sound[58:]:
        spotter.heard(frame, 0.2)

    (seen,) = encoder.seen
    np.testing.assert_array_equal(seen, sound.ravel()[-SAMPLES:])


def test_it_is_awake_for_a_second_after_a_voice():
    encoder = Encoder()
    spotter = StopSpotter(encoder, read_weights())

    spotter.heard(np.zeros(FRAME_SAMPLES, np.int16), 0.9)
    for _ in range(100):
        spotter.heard(np.zeros(FRAME_SAMPLES, np.int16), 0.0)

    assert len(encoder.seen) == round(AWAKE_S / FRAME_S) // LOOKS_EVERY
    assert spotter.likelihood == 0


@pytest.fixture
def judge():
    return StopJudge(read_weights(), threshold=0.9)


def test_no_single_look_stops_a_robot(judge):
    assert not any(judge.said(look) for look in (NOTHING, HALT, NOTHING, NOTHING, HALT, NOTHING))


def test_a_word_stops_it_once_while_it_is_heard(judge):
    looks = [NOTHING, *[HALT] * int(REST_S / LOOK_S), NOTHING]

    found = [judge.said(look if not frame else None) for look in looks for frame in range(2)]

    assert sum(found) == 1
    assert judge.word == "halt"


def test_a_word_that_is_said_again_later_stops_it_again(judge):
    rest = int(REST_S / LOOK_S) + 1
    said = [HALT] * SMOOTHED_LOOKS
    looks = [*said, *[NOTHING] * rest, *said]

    found = [judge.said(look if not frame else None) for look in looks for frame in range(2)]

    assert sum(found) == 2


def test_between_looks_nothing_counts(judge):
    assert any(judge.said(HALT) for _ in range(SMOOTHED_LOOKS))

    assert not any(judge.said(None) for _ in range(200))


def test_after_it_forgot_one_look_is_not_enough(judge):
    judge.said(HALT)
    judge.forget()

    assert [judge.said(HALT) for _ in range(SMOOTHED_LOOKS)] == [
        *[False] * (SMOOTHED_LOOKS - 1),
        True,
    ]


def test_what_is_no_word_needs_no_second_look(judge):
    def second():
        pytest.fail("nobody thought of a word")

    assert not any(judge.said(look, second) for look in (NOTHING, HARDLY, NOTHING, NOTHING))


@pytest.mark.parametrize(
    ("look", "likely", "stops"),
    [
        (MAYBE, 0.08, True),
        (MAYBE, 0.04, False),
        (HALT, 0.0005, True),
        (HALT, 0.0, False),
    ],
)
def test_the_squared_odds_of_the_network_times_the_second_likelihood_decide(
    judge, look, likely, stops
):
    found = [judge.said(look, lambda: likely) for _ in range(SMOOTHED_LOOKS)]

    assert any(found) is stops
    assert judge.word == ("halt" if stops else "")


@pytest.mark.parametrize(
    ("stands_out_db", "times"),
    [(None, 1), (0.0, 1), (NOISY_DB, 1), (QUIET_DB, QUIET_TIMES), (60.0, QUIET_TIMES)],
)
def test_in_quiet_the_odds_must_be_higher(judge, stands_out_db, times):
    least = LEAST_ODDS * times / (LIKELY[1:].sum() / LIKELY[0]) ** 2

    def stops(likely):
        judge.forget()
        said = [judge.said(LIKELY, lambda: likely, lambda: stands_out_db) for _ in range(5)]
        return any(said)

    assert not stops(0.8 * least)
    assert stops(1.2 * least)


@pytest.mark.parametrize("playing", [False, True])
def test_while_the_robot_speaks_it_never_sleeps(playing):
    """What is heard of a person may be cut out of what the voice detector hears then."""
    encoder = Encoder()
    spotter = StopSpotter(encoder, read_weights())

    for frame in hiss(10 * FRAME_SAMPLES).reshape(-1, FRAME_SAMPLES):
        spotter.heard(frame, 0.0, playing=playing)

    assert len(encoder.seen) == (10 // LOOKS_EVERY if playing else 0)


@pytest.mark.parametrize("playing", [False, True])
def test_while_the_robot_speaks_nothing_is_quiet(monkeypatch, playing):
    silence, voice = (np.full(FRAME_SAMPLES, level, np.int16) for level in (3, 3_000))
    monkeypatch.setattr(stop_spotter, "likelihoods", lambda *_: LIKELY[None])
    spotter = StopSpotter(Encoder(), read_weights(), second=lambda _: 0.03)
    for _ in range(20):
        spotter.heard(silence, 0.01)

    found = [spotter.heard(voice, 0.9, playing=playing) for _ in range(20)]

    assert any(found) is playing


def test_where_the_second_look_fails_the_threshold_decides(judge):
    assert not any(judge.said(MAYBE, lambda: None) for _ in range(SMOOTHED_LOOKS))
    assert any(judge.said(HALT, lambda: None) for _ in range(SMOOTHED_LOOKS))


def test_it_asks_a_few_times_about_what_may_be_one_word_and_again_about_the_next(judge):
    asked = []

    def second():
        asked.append(len(asked))
        return 0.0

    for look in ([MAYBE] * 20, [NOTHING] * 3, [MAYBE] * 20):
        for one in look:
            judge.said(one, second)

    assert len(asked) == 2 * MOST_ASKED


def test_who_says_it_again_and_again_is_asked_about_for_as_long(judge):
    told = iter([0.0] * 3 * MOST_ASKED + [0.9])

    found = [judge.said(HALT, lambda: next(told)) for _ in range(3 * MOST_ASKED + 1)]

    assert found.index(True) == 3 * MOST_ASKED


def test_once_a_word_has_stopped_it_nobody_looks_again_at_what_is_left_of_it(judge):
    asked = []

    def second():
        asked.append(len(asked))
        return 1.0

    assert sum(judge.said(MAYBE, second) for _ in range(int(REST_S / FRAME_S))) == 1
    assert len(asked) == 1


def test_what_is_left_of_a_word_does_not_stop_it_again(judge):
    def stops(look, frames):
        return sum(judge.said(look, lambda: 1.0) for _ in range(frames))

    long = 2 * int(REST_S / FRAME_S)

    assert stops(HALT, 6) == 1
    assert stops(MAYBE, long) == 0
    assert stops(HALT, 6) == 1, "somebody says it again"
    assert stops(MAYBE, long) == 0
    assert stops(NOTHING, 3) == 0
    assert stops(MAYBE, 6) == 1


def test_a_second_look_sees_the_last_seconds(monkeypatch):
    monkeypatch.setattr(stop_spotter, "likelihoods", lambda *_: MAYBE[None])
    seen, sound = [], hiss(100 * FRAME_SAMPLES)

    def second(heard):
        seen.append(heard)
        return 0.0

    spotter = StopSpotter(Encoder(), read_weights(), second=second)

    for frame in sound.reshape(-1, FRAME_SAMPLES):
        spotter.heard(frame, 1.0)

    assert len(seen) == MOST_ASKED
    at = LOOKS_EVERY * (1 + MOST_ASKED) * FRAME_SAMPLES  # the mean of one look is too little
    np.testing.assert_array_equal(seen[-1][-at:], sound[:at])
    assert seen[-1].size == LOOKED_AT


def test_a_second_look_that_fails_is_counted_and_what_is_sure_stops_all_the_same(monkeypatch):
    looks = iter([MAYBE] * 4 + [HALT] * 8)
    monkeypatch.setattr(stop_spotter, "likelihoods", lambda *_: next(looks)[None])

    def fails(_):
        raise RuntimeError("no memory")

    spotter = StopSpotter(Encoder(), read_weights(), 0.9, fails)
    frames = np.zeros((12 * LOOKS_EVERY, FRAME_SAMPLES), np.int16)

    assert sum(spotter.heard(frame, 1.0) for frame in frames) == 1
    assert spotter.failed == 6  # from the second look in doubt to the one that is sure
