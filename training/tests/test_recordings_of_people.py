"""Recordings of people: who says which word, and on which side of the split."""

import wave

import numpy as np
import pytest

from training.acoustics import Half, people
from training.acoustics.mixing import voiced_part
from training.spotter.examples import Examples, Sound
from training.spotter.languages import sounds_of_people


def record(file, samples):
    file.parent.mkdir(parents=True, exist_ok=True)
    with wave.open(str(file), "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(16_000)
        out.writeframes(samples.astype("<i2").tobytes())


@pytest.fixture
def folder(tmp_path, monkeypatch):
    said = np.zeros(16_000, np.int16)
    for name in (
        "stop/0ab3b47d_nohash_0.wav",
        "_unknown_/bed_0ab3b47d_nohash_1.wav.wav",
        "_silence_/12.wav",
        "left/notes.wav",
    ):
        record(tmp_path / name, said)
    monkeypatch.setenv(people.FOLDER, str(tmp_path))
    return tmp_path


def test_the_folder_names_the_word_and_the_file_the_speaker(folder):
    found = {(one.word, one.speaker, one.samples.size) for one in people.recordings()}

    assert found == {("stop", "0ab3b47d", 16_000), ("bed", "0ab3b47d", 16_000)}


def test_without_a_folder_nobody_says_anything(monkeypatch):
    monkeypatch.delenv(people.FOLDER, raising=False)

    assert not list(people.recordings())


def test_nobody_is_on_both_sides():
    speakers = [f"{number:08x}" for number in range(300)]

    parts = {one: people.part_of(one) for one in speakers}

    assert set(parts.values()) == set(Half)
    for one, part in parts.items():
        assert (part is Half.HELD_OUT) is (people.half_of(one) is Half.HELD_OUT)


def test_a_word_is_cut_out_of_the_silence_around_it():
    sound = np.zeros(16_000, np.int16)
    sound[4_800:8_000] = 3_000

    assert voiced_part(sound).size == 3_200


def test_only_those_who_train_are_learnt_from(tmp_path, monkeypatch):
    speakers = [f"{number:08x}" for number in range(40)]
    said = np.full(1_600, 1_000, np.int16)
    for one in speakers:
        record(tmp_path / f"stop/{one}_nohash_0.wav", said)
        record(tmp_path / f"left/{one}_nohash_0.wav", said)
    monkeypatch.setenv(people.FOLDER, str(tmp_path))
    training = [one for one in speakers if people.part_of(one) is Half.TRAIN]

    found = [one.word for one in sounds_of_people()]

    assert sorted(found) == [0] * len(training) + [1] * len(training)


def test_words_are_drawn_by_their_shares():
    tone = (3_000 * np.sin(np.arange(4_000) / 9)).astype(np.int16)
    sounds = [Sound(tone, word, False) for word in range(4)]
    made = Examples(sounds, np.random.default_rng(1), shares=(0.0, 1.0, 0.0))

    assert {one.word for one in (made.make() for _ in range(40))} == {0, 2}
