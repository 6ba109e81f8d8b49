"""What trains the adapter of hearing, but for the network itself."""

import hashlib
import random

import numpy as np
import pytest
from stop_words_rig import Half, Speaker, training_clips, voices
from whisper_files import HALF, WEIGHTS, array, file_of

from edgevox.voice.stt.adapter import ADAPTER_FILE, DOWN, FILE, MODEL, SIZE, UP, added_of
from training.adapter import clips, texts, utterances
from training.adapter import train as train_hearing_adapter
from training.whisper import tracks

NAME = "encoder/weight"
LEARNT = {f"{NAME}{UP}": np.ones((2, 1), np.float16), f"{NAME}{DOWN}": np.ones((1, 3), np.float16)}


@pytest.mark.parametrize(
    ("said", "written"),
    [
        ("Walk forward one metre.", "Walk forward 1 meter."),
        ("Turn left by ninety degrees.", "Turn left by 90 degrees."),
        ("Spin right two hundred and seventy degrees.", "Spin right 270 degrees."),
        ("Go ahead one and a half metres.", "Go ahead one and a half meters."),
        ("Step back half a metre.", "Step back half a meter."),
        ("Room twelve, please.", "Room 12, please."),
        ("One of two.", "One of two."),
    ],
)
def test_numbers_are_learnt_as_whisper_writes_them(said, written):
    assert texts.written(said) == written


@pytest.fixture
def all_clips(monkeypatch, tmp_path):
    """All clips of the training, none of them spoken."""
    known = [*voices.kokoro_voices(Half.HELD_OUT), *voices.kokoro_voices(Half.TUNING)]
    (tmp_path / "voices").mkdir()
    chatting = training_clips.texts.CHATTING
    others = [f"kokoro:{name}" for name in ("jf_alpha", "ff_siwis", "am_adam", "bm_lewis")]
    for voice in [*known, *chatting, *others]:
        (tmp_path / "voices" / f"{voice.removeprefix('kokoro:')}.bin").touch()
    monkeypatch.setattr(voices, "locate", lambda _: tmp_path)
    monkeypatch.setattr(training_clips, "dictionary", lambda: ["house", "river"] * 9)
    monkeypatch.setattr(training_clips, "alike", lambda: ["shop", "salt"] * 10)
    monkeypatch.setattr(clips, "SPOTTER_CLIPS", 300)
    return clips.all_clips()


def test_it_learns_from_no_voice_and_no_sentence_that_tests(all_clips):
    learnt = {clip.voice for clip in all_clips}

    for half in (Half.HELD_OUT, Half.TUNING):
        assert learnt.isdisjoint(voices.kokoro_voices(half))
        assert learnt.isdisjoint(voices.espeak_voices(half))
    assert texts.TESTED.isdisjoint(clip.text for clip in all_clips)


def test_half_of_what_is_learnt_is_talk_that_no_robot_was_meant_by(all_clips):
    odds = utterances.odds_of(all_clips)

    for kind in clips.Kind:
        share = sum(
            one for one, clip in zip(odds, all_clips, strict=True) if clips.kind_of(clip) is kind
        )
        assert share == pytest.approx(kind.value)


@pytest.fixture
def made(monkeypatch):
    Speaker(monkeypatch)
    said = [clips.Clip("kokoro:af_heart", text) for text in ("Stop!", "Go home.", "x " * 40)]
    said[0] = clips.Clip("kokoro:af_heart", "Stop!", "stop")
    return utterances.Utterances(said, 1)


def test_utterances_are_no_longer_than_what_whisper_transcribes_at_once(made):
    some = [made.make() for _ in range(60)]

    assert max(one.track.size for one in some) <= utterances.SHORT_S * 16_000


def test_now_and_then_nobody_speaks_and_nothing_is_to_be_heard(made):
    nobody = [one for one in (made.make() for _ in range(60)) if not one.text]

    assert 0 < len(nobody) < 20
    assert not any(np.any(one.track) for one in nobody)


def test_voices_that_talk_at_once_fill_a_noise_of_the_loudness_of_the_others(made):
    babble = made.babble()

    assert babble.size == utterances.NOISE_S * 16_000
    assert np.sqrt(np.mean(babble**2)) == pytest.approx(1, abs=1e-3)


def test_numbers_are_drawn_as_often_as_their_weights_say():
    drawn, rng = tracks.Drawn(np.array([1.0, 0.0, 3.0])), np.random.default_rng(1)
    found = np.bincount([drawn.one(rng) for _ in range(2_000)], minlength=3) / 2_000

    np.testing.assert_allclose(found, [0.25, 0, 0.75], atol=0.05)


def test_a_prompt_has_what_was_said_among_it_only_sometimes():
    rng = random.Random(1)
    shown = ["Zoom!" in utterances.prompt(rng, "Zoom!") for _ in range(100)]

    assert 20 < sum(shown) < 60


@pytest.fixture
def model(tmp_path):
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / FILE).write_bytes(file_of(array(NAME, HALF, WEIGHTS)))
    return folder


@pytest.fixture
def place(tmp_path):
    there = tmp_path / "package" / ADAPTER_FILE
    there.parent.mkdir()
    there.write_bytes(b"as it was")
    return there


@pytest.fixture
def installs(monkeypatch, tmp_path, model, place):
    """Installs what was learnt, and tells the exit code."""
    monkeypatch.setattr(train_hearing_adapter, "locate", lambda _: model)

    def install(learnt):
        folder = tmp_path / "trained"
        folder.mkdir()
        with (folder / ADAPTER_FILE).open("wb") as out:
            np.savez(out, **learnt)
        return train_hearing_adapter.main([str(folder), "--install"], place)

    return install


def test_what_was_learnt_is_installed_with_the_digest_of_its_model(installs, model, place):
    assert installs(LEARNT) == 0

    with np.load(place) as data:
        held = (model / FILE).read_bytes()
        assert str(data[MODEL]) == hashlib.sha256(held).hexdigest()
        assert int(data[SIZE]) == len(held)
        share = train_hearing_adapter.ADDED_SHARE
        np.testing.assert_allclose(added_of(data)[NAME].numbers, np.full(6, share), atol=1e-3)
    assert [one.name for one in place.parent.iterdir()] == [ADAPTER_FILE]


@pytest.mark.parametrize(
    ("learnt", "reason"),
    [
        ({**LEARNT, f"{NAME}{UP}": np.full((2, 1), np.nan, np.float16)}, "no number"),
        ({**LEARNT, f"{NAME}{UP}": np.ones((4, 1), np.float16)}, NAME),
        ({f"other{UP}": np.ones((2, 1)), f"other{DOWN}": np.ones((1, 3))}, "other"),
        ({f"{NAME}{UP}": np.ones((2, 1))}, DOWN),
    ],
)
def test_what_does_not_fit_the_model_is_not_installed(installs, place, capsys, learnt, reason):
    assert installs(learnt) == 1

    assert reason in capsys.readouterr().err
    assert place.read_bytes() == b"as it was"


def test_nothing_is_installed_before_anything_was_learnt(monkeypatch, tmp_path, model, place):
    monkeypatch.setattr(train_hearing_adapter, "locate", lambda _: model)

    assert train_hearing_adapter.main([str(tmp_path), "--install"], place) == 1
    assert place.read_bytes() == b"as it was"


def test_the_program_asks_for_pytorch_only_to_train():
    assert "torch" not in {name.partition(".")[0] for name in vars(train_hearing_adapter)}
