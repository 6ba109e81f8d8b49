"""What trains the stop word spotter, but for the network itself: it goes on, and it overwrites
nothing unasked.
"""

import sys

import numpy as np
import pytest
from stop_words_rig import (
    Half,
    Speaker,
    clips,
    examples,
    installing,
    pool,
    random_states,
    schedule,
    train_stop_spotter,
    training_clips,
    voices,
)

from edgevox.voice.stop_network import read_weights, weights_of

SHIPPED = train_stop_spotter.PLACE


def made(rng, number: int):
    return [
        (
            rng.normal(size=(8, 3)).astype(np.float16),
            rng.integers(-2, 4, 4).astype(np.int8),
            int(rng.integers(4)),
        )
        for _ in range(number)
    ]


def test_the_rate_goes_by_steps_up_soon_and_down_to_the_end():
    rates = [schedule.rate(step, 1000) for step in range(1000)]

    assert rates[0] == pytest.approx(schedule.FASTEST / schedule.WARMING_STEPS)
    top = rates.index(max(rates))
    assert top == pytest.approx(schedule.WARMING_STEPS, abs=2)
    assert rates[top:] == sorted(rates[top:], reverse=True)
    assert 0 < rates[-1] < 0.02 * schedule.FASTEST


def test_a_pool_keeps_the_newest_examples():
    rng, kept = np.random.default_rng(1), pool.Pool(10)
    all_made = made(rng, 14)

    kept.add(all_made[:8])
    where = kept.add(all_made[8:])

    assert len(kept) == 10
    batch = kept.batch(where, 6, rng)
    for at, (rows, labels, word) in enumerate(all_made[8:]):
        np.testing.assert_array_equal(batch.rows[at], rows)
        np.testing.assert_array_equal(batch.labels[at], labels)
        assert batch.words[at] == word


def test_what_costs_more_is_learnt_from_more_often():
    rng, kept = np.random.default_rng(1), pool.Pool(10)
    where = kept.add(made(rng, 10))
    kept.costed(where, np.array([2.0, *np.zeros(9)]))

    drawn = np.concatenate([kept.batch(where[9:], 3, rng).where[:2] for _ in range(200)])

    share = np.mean(drawn == 0)
    assert share == pytest.approx(2.1 / (2.1 + 8 * 0.1), abs=0.1)
    assert 9 not in drawn  # the fresh one is in every batch, once


def test_a_pool_goes_on_from_its_state_as_if_never_cut_off():
    rng, kept = np.random.default_rng(1), pool.Pool(10)
    kept.costed(kept.add(made(rng, 12)), rng.uniform(0, 3, 12))
    later, state = pool.Pool(10), {name: one.copy() for name, one in kept.state().items()}

    later.resume(state)

    fresh = made(rng, 2)
    drawn = [one.batch(one.add(fresh), 8, np.random.default_rng(7)) for one in (kept, later)]
    np.testing.assert_array_equal(drawn[0].where, drawn[1].where)
    np.testing.assert_array_equal(drawn[0].rows, drawn[1].rows)


def test_draws_go_on_from_their_state_as_if_never_cut_off():
    one, other = np.random.default_rng(3), np.random.default_rng(4)
    one.normal(size=5)

    random_states.resume(other, random_states.state_of(one))

    assert list(one.integers(0, 1000, 9)) == list(other.integers(0, 1000, 9))


@pytest.fixture
def speaker(monkeypatch):
    return Speaker(monkeypatch)


def test_examples_go_on_from_their_state_as_if_never_cut_off(monkeypatch):
    monkeypatch.setattr(examples, "kinds", lambda _: ("white", "pink"))
    tone = (3000 * np.sin(np.arange(9_000) / 9)).astype(np.int16)
    sounds = [examples.Sound(tone, word, False) for word in range(4)]
    one, other = examples.Examples(sounds, 1), examples.Examples(sounds, 1)
    for _ in range(3):
        one.make()

    other.resume(one.state())

    for left, right in zip(one.make(), other.make(), strict=True):
        np.testing.assert_array_equal(left, right)


def test_a_training_that_goes_on_keeps_the_clips_that_it_began_with(speaker, tmp_path):
    some = [clips.Clip("kokoro:af_heart", f"Go {number}.") for number in range(5)]
    clips.speak(some[:3], lambda _: None)

    begun = train_stop_spotter.to_learn(tmp_path, some, only_spoken=True)
    clips.speak(some, lambda _: None)

    assert begun == some[:3]
    assert train_stop_spotter.to_learn(tmp_path, some, only_spoken=True) == begun
    assert train_stop_spotter.to_learn(tmp_path, some, only_spoken=False) == begun
    with pytest.raises(SystemExit, match="take another folder"):
        train_stop_spotter.to_learn(tmp_path, some[1:], only_spoken=True)


def test_it_learns_from_no_voice_that_tunes_or_tests(monkeypatch, tmp_path):
    known = [*voices.kokoro_voices(Half.HELD_OUT), *voices.kokoro_voices(Half.TUNING)]
    (tmp_path / "voices").mkdir()
    for voice in [*known, *training_clips.texts.CHATTING]:
        (tmp_path / "voices" / f"{voice.removeprefix('kokoro:')}.bin").touch()
    monkeypatch.setattr(voices, "locate", lambda _: tmp_path)
    monkeypatch.setattr(training_clips, "dictionary", lambda: ["house", "river"] * 9)

    learnt = {clip.voice for clip in training_clips.all_clips()}

    for half in (Half.HELD_OUT, Half.TUNING):
        assert learnt.isdisjoint(voices.kokoro_voices(half))
        assert learnt.isdisjoint(voices.espeak_voices(half))


@pytest.fixture
def place(tmp_path):
    """A place to install to, where something is already."""
    there = tmp_path / "package" / "stop_spotter.npz"
    there.parent.mkdir()
    there.write_bytes(b"as it was")
    return there


@pytest.fixture
def trained(tmp_path):
    """The folder of a training."""
    folder = tmp_path / "trained"
    folder.mkdir()
    (folder / "stop_spotter.npz").write_bytes(SHIPPED.read_bytes())
    return folder


def test_what_was_trained_is_installed_where_that_is_asked_for_with_its_threshold(trained, place):
    asked = [str(trained), "--install", "--threshold", "0.77"]

    assert train_stop_spotter.main(asked, place) == 0

    with np.load(place) as data:
        found = weights_of(data)
    assert found.threshold == 0.77
    np.testing.assert_array_equal(found.first, read_weights().first)
    assert [one.name for one in place.parent.iterdir()] == [place.name]


def test_nothing_is_installed_without_a_threshold(trained, place, capsys):
    with pytest.raises(SystemExit):
        train_stop_spotter.main([str(trained), "--install"], place)

    assert "--threshold" in capsys.readouterr().err
    assert place.read_bytes() == b"as it was"


@pytest.mark.parametrize("threshold", ["0", "1", "1.5", "-0.2"])
def test_a_threshold_that_always_or_never_stops_is_refused(trained, place, capsys, threshold):
    asked = [str(trained), "--install", f"--threshold={threshold}"]

    assert train_stop_spotter.main(asked, place) == 1

    assert "threshold" in capsys.readouterr().err
    assert place.read_bytes() == b"as it was"


@pytest.mark.parametrize("held", [b"", b"no archive", None])
def test_a_file_that_is_not_one_of_the_spotter_changes_nothing(trained, place, capsys, held):
    file = trained / "stop_spotter.npz"
    if held is None:
        file.unlink()
    else:
        file.write_bytes(held)

    assert train_stop_spotter.main([str(trained), "--install", "--threshold", "0.8"], place) == 1

    assert str(file) in capsys.readouterr().err
    assert place.read_bytes() == b"as it was"


def test_weights_that_say_no_number_are_not_installed(trained, place):
    file = trained / "stop_spotter.npz"
    with np.load(file) as data:
        broken = {**data}
    broken["last_bias"] = np.full_like(broken["last_bias"], np.nan)
    with file.open("wb") as out:
        np.savez(out, **broken)

    with pytest.raises(installing.NotInstalled, match="no number"):
        installing.install(file, place, 0.8)

    assert place.read_bytes() == b"as it was"


def test_the_program_asks_for_pytorch_only_to_train():
    assert "torch" not in {name.partition(".")[0] for name in vars(train_stop_spotter)}
    assert "stop_spotter.training" not in sys.modules
