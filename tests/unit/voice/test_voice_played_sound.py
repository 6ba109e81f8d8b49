"""What was played is found again by the time at which it was heard."""

import numpy as np
import pytest
from support.clock import HeldClock

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Chunk
from edgevox.voice.echo.canceller import CapturePosition
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.sinks.card import CardQueue
from edgevox.voice.sinks.paced import PacedSink, Relay

COUNT = 1600


def ramp(count=COUNT):
    return np.arange(1, count + 1, dtype=np.int16)


def test_sound_is_found_at_its_time_and_silence_around_it():
    played = PlayedSound()
    played.add(ramp(), RATE_HZ, 100.0)

    found = played.between(100 * RATE_HZ - 10, COUNT + 20)

    assert np.array_equal(found, [*[0] * 10, *ramp(), *[0] * 10])


def test_pieces_whose_times_are_told_inexactly_follow_on_each_other_without_a_gap():
    played = PlayedSound()
    for number, late_s in enumerate((0.0, 0.007, -0.004)):
        played.add(ramp(), RATE_HZ, 100.0 + number * 0.1 + late_s)

    assert np.array_equal(played.between(100 * RATE_HZ, 3 * COUNT), np.tile(ramp(), 3))


def test_a_piece_after_a_pause_stands_at_its_own_time():
    played = PlayedSound()
    played.add(ramp(), RATE_HZ, 100.0)
    played.add(ramp(), RATE_HZ, 101.0)

    found = played.between(100 * RATE_HZ, 2 * RATE_HZ)

    assert np.array_equal(found[RATE_HZ : RATE_HZ + COUNT], ramp())
    assert not found[COUNT:RATE_HZ].any()


def test_what_was_cut_was_not_played():
    played = PlayedSound()
    played.add(ramp(), RATE_HZ, 100.0)
    played.cut(100.05)

    found = played.between(100 * RATE_HZ, COUNT)

    assert np.array_equal(found, [*ramp(800), *[0] * 800])


def test_another_rate_becomes_16_khz():
    played = PlayedSound()
    hum = 8000 * np.sin(2 * np.pi * 440 * np.arange(48_000) / 48_000)
    played.add(hum.astype(np.int16), 48_000, 100.0)

    found = played.between(100 * RATE_HZ, 15_000)

    wanted = 8000 * np.sin(2 * np.pi * 440 * np.arange(15_000) / RATE_HZ)
    assert np.abs(found[2000:] - wanted[2000:]).max() < 400


def test_what_nobody_asks_for_does_not_pile_up():
    played = PlayedSound()
    for number in range(20_000):
        played.add(ramp(160), RATE_HZ, 100.0 + number * 0.01)

    assert played.between(100 * RATE_HZ, 160).any() is np.False_
    assert played.between(round(299.9 * RATE_HZ), 160).any()


def test_a_card_tells_what_it_was_given_and_not_its_silence():
    played = PlayedSound()
    queue = CardQueue(HeldClock(100.0), played)
    queue.open(RATE_HZ)
    queue.fill(160, 0.04)
    queue.add(ramp(160))
    queue.fill(160, 0.04)

    found = played.between(100 * RATE_HZ, 1600)

    assert np.array_equal(found[found > 0], ramp(160))


def test_a_relay_tells_what_is_due_and_takes_back_what_a_stop_keeps_from_it():
    time, played = HeldClock(100.0), PlayedSound()

    def wait(token, seconds):
        time.now_s += seconds
        return token.cancelled

    sink = PacedSink(Relay(), clock=time, wait=wait, played=played)
    sink.play(Chunk(ramp(8000), RATE_HZ), CancelToken())
    now_s = time.now_s
    sink.stop()

    found = played.between(100 * RATE_HZ, 8000)

    assert found[: round((now_s - 100.0) * RATE_HZ)].all()
    assert not found[round((now_s + Relay.lead_s - 100.0) * RATE_HZ) + 1 :].any()


@pytest.mark.parametrize("latest_s", [0.0, 0.02, 0.1])
def test_frames_have_one_position_after_the_other_however_late_they_come(latest_s):
    position, rng = CapturePosition(), np.random.default_rng(2)
    late = [0.0, *rng.uniform(0, latest_s, 300)]

    found = [
        position.take(100.0 + number * FRAME_S + late_s, quiet=False)
        for number, late_s in enumerate(late)
    ]

    assert set(np.diff(found)) == {FRAME_SAMPLES}


def test_after_lost_sound_the_position_is_the_true_one_again():
    position = CapturePosition()
    before = [position.take(100.0 + number * FRAME_S, quiet=False) for number in range(100)]

    after = position.take(100.0 + 99 * FRAME_S + 1.0, quiet=False)

    assert after - before[-1] == RATE_HZ
