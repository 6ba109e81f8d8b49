"""Recordings of people: who says which word, and on which side of the split."""

import wave

import numpy as np
import pytest

from training.acoustics import Half, people


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

    assert people.spoken(sound).size == 3_200
