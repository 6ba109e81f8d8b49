"""What trains the stop word spotter, but for the network itself: it goes on, and it overwrites
nothing unasked.
"""

import sys

import numpy as np
import pytest
from stop_words_rig import (
    Half,
    Speaker,
    examples,
    installing,
    outputs,
    train_stop_spotter,
    training_clips,
    voices,
)

from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stop_spotter.network import SAMPLES, read_weights, weights_of

SHIPPED = train_stop_spotter.PLACE


@pytest.fixture
def speaker(monkeypatch):
    return Speaker(monkeypatch)


@pytest.fixture
def makes():
    tone = (3000 * np.sin(np.arange(9_000) / 9)).astype(np.int16)
    sounds = [examples.Sound(tone, word, word == 3) for word in range(4)]
    return lambda: examples.Examples(sounds, np.random.default_rng(1))


def test_the_same_seed_makes_the_same_examples(makes):
    one, other = makes(), makes()

    for _ in range(4):
        np.testing.assert_array_equal(one.make().track, other.make().track)


def test_a_word_is_in_its_example_from_when_it_begins_to_when_it_ends(makes):
    maker = makes()
    with_word = [one for one in (maker.make() for _ in range(40)) if one.word]

    assert with_word
    for one in with_word:
        begins, ends = (int(when * RATE_HZ) for when in (one.begins_s, one.ends_s))
        assert ends - begins == pytest.approx(9_000, rel=0.2)
        assert np.sqrt(np.mean(one.track[begins:ends] ** 2)) == pytest.approx(1, abs=0.05)


NOTHING = examples.silence(examples.TRACK_S)
SAID = examples.Example(NOTHING, 2, False, begins_s=1.5, ends_s=2.0)
WITHIN = examples.Example(NOTHING, 2, True, begins_s=1.0, ends_s=2.0)
NONE = examples.Example(NOTHING)


@pytest.mark.parametrize(
    ("example", "when_s", "label"),
    [
        (SAID, 1.4, 0),
        (SAID, 1.8, examples.IGNORED),
        (SAID, 2.01, 2),
        (SAID, 2.2, 2),
        (SAID, 2.5, examples.IGNORED),
        (SAID, 3.19, 0),
        (WITHIN, 1.2, examples.IGNORED),
        (WITHIN, 1.6, 2),
        (WITHIN, 1.9, examples.IGNORED),
        (NONE, 2.0, 0),
    ],
)
def test_a_look_is_to_find_a_word_that_has_just_been_said(example, when_s, label):
    assert example.label(when_s) == label


def test_each_word_is_looked_at_when_it_is_to_be_heard():
    rng = np.random.default_rng(1)

    for example in (SAID, WITHIN):
        labels = [example.label(when) for _ in range(50) for when in example.times(rng)]
        assert labels.count(2) >= 100
    assert {NONE.label(when) for _ in range(50) for when in NONE.times(rng)} == {0}


def test_every_look_has_all_that_it_sees(makes):
    rng, made = np.random.default_rng(1), makes()

    for example in (made.make() for _ in range(20)):
        whens = [when * RATE_HZ for when in example.times(rng)]
        assert all(SAMPLES <= when <= example.track.size for when in whens)


def test_each_engine_says_its_share_however_many_clips_of_it_there_are(speaker):
    clip = training_clips.clip_of
    voices_of = ["kokoro:af_heart", *["espeak:en-us+m1"] * 5, training_clips.PIPER]
    said = [clip(voice, f"Stop {n}!") for n, voice in enumerate(voices_of)]
    said += [clip("kokoro:af_heart", "Go home."), clip("espeak:en-us+m1", "Go away.")]

    weights = [one.weight for one in outputs.sounds_of("en", said)]

    shares = outputs.SHARES
    assert weights[0] == shares["kokoro"]
    assert sum(weights[1:6]) == pytest.approx(shares["espeak"])
    assert weights[6:] == [shares["piper"], shares["kokoro"], shares["espeak"]]


def test_it_learns_from_no_voice_that_tunes_or_tests(monkeypatch, tmp_path):
    known = [*voices.kokoro_voices(Half.HELD_OUT), *voices.kokoro_voices(Half.TUNING)]
    (tmp_path / "voices").mkdir()
    for voice in [*known, *training_clips.texts.CHATTING]:
        (tmp_path / "voices" / f"{voice.removeprefix('kokoro:')}.bin").touch()
    monkeypatch.setattr(voices, "locate", lambda _: tmp_path)
    monkeypatch.setattr(training_clips, "dictionary", lambda: ["house", "river"] * 9)
    monkeypatch.setattr(training_clips, "alike", lambda: ["shop", "salt"] * 10)

    learnt = {clip.voice for clip in training_clips.all_clips()}

    for half in (Half.HELD_OUT, Half.TUNING):
        assert learnt.isdisjoint(voices.kokoro_voices(half))
        assert learnt.isdisjoint(voices.espeak_voices(half))


def test_what_sounds_like_a_stop_word_is_none_and_no_other_word_that_sounds_the_same():
    known = training_clips.alike()

    assert {"top", "shop", "salt", "breeze"} <= set(known)
    assert not {"stop", "halt", "freeze", "frees", "stopped"} & set(known)
    assert known.count("top") > known.count("shop")


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
    np.testing.assert_array_equal(found.place, read_weights().place)
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
    assert "stop_spotter.learning" not in sys.modules
