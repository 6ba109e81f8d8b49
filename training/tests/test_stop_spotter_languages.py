"""The stop word spotter where another language than English is spoken."""

import dataclasses
import shutil
from pathlib import Path

import numpy as np
import pytest
from stop_words_rig import (
    Half,
    examples,
    installing,
    language_clips,
    languages,
    outputs,
    stop_words_ears,
    train_stop_spotter,
    voices,
)

from edgevox.core.languages import LANGUAGES
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES
from edgevox.voice.stop_spotter import network
from edgevox.voice.stop_spotter import spotter as stop_spotter
from edgevox.voice.stop_spotter.network import (
    CHANNELS,
    LANGUAGES_FILE,
    STEPS,
    WEIGHTS_FILE,
    likelihoods,
    read_language_weights,
    read_weights,
)
from edgevox.voice.stop_spotter.spotter import LOOKS_EVERY, REST_S, StopSpotter

SHIPPED = Path(network.__file__).with_name(LANGUAGES_FILE)
KNOWN = sorted(read_language_weights())
NOTHING, ENGLISH, OWN = 0.0, 1.0, 2.0
"""How loud a frame is in which nothing, an English stop word or one of the language is said."""


class Encoder:
    """Makes of each sound how loud its last frame is."""

    def of(self, sounds):
        return np.stack([np.full((STEPS, CHANNELS), float(one[-1])) for one in sounds])

    def probability(self, _):
        return 1.0

    def reset(self):
        pass


@pytest.fixture
def others(monkeypatch):
    """The networks hear what `Encoder` makes: the English one its level, each other one its own."""
    english = len(read_weights().words)

    def look(weights, encoded):
        is_english = len(weights.words) == english
        said = encoded[:, 0, 0] == (ENGLISH if is_english else OWN)
        rows = np.zeros((len(said), len(weights.words)), np.float32)
        rows[np.arange(len(said)), np.where(said, 2, 0)] = 1
        return rows

    for module in (stop_spotter, stop_words_ears):
        monkeypatch.setattr(module, "likelihoods", look)
    known = read_language_weights().items()
    return {code: dataclasses.replace(one, threshold=0.9) for code, one in known}


def frames(*said):
    """Of each level a look's frames, then so many that the next word is a new one."""
    levels = []
    for level in said:
        levels += [level] * 4 * LOOKS_EVERY + [NOTHING] * (round(REST_S / FRAME_S) + 4)
    return np.repeat(levels, FRAME_SAMPLES).astype(np.int16).reshape(-1, FRAME_SAMPLES)


def words_heard(spotter, sound, language):
    return [spotter.word for frame in sound if spotter.heard(frame, 1.0, language)]


@pytest.mark.parametrize("language", KNOWN)
def test_its_words_stop_the_robot_wherever_they_stand(language):
    words = read_language_weights()[language].words

    assert words[0] == ""
    assert len(words) > 2
    assert set(words[1:]) <= set(LANGUAGES[language].stop.anywhere)


def test_each_language_is_judged_by_its_own_outputs():
    some = np.random.default_rng(7).normal(0, 3, (3, STEPS, CHANNELS)).astype(np.float32)

    for weights in read_language_weights().values():
        found = likelihoods(weights, some)
        assert found.shape == (3, len(weights.words))
        np.testing.assert_allclose(found.sum(1), 1, atol=1e-5)


def test_they_were_learnt_on_the_encoder_that_is_here():
    with np.load(SHIPPED) as data:
        learnt_on = str(data["encoder"])

    with np.load(SHIPPED.with_name(WEIGHTS_FILE)) as english:
        assert learnt_on == installing.encoder_of(english)


def test_words_of_a_language_stop_it_where_that_is_spoken_and_english_ones_everywhere(others):
    sound, (own, other) = frames(ENGLISH, OWN), KNOWN[:2]
    halt, word = read_weights().words[2], others[own].words[2]

    def spotter():
        return StopSpotter(Encoder(), read_weights(), 0.9, others=others)

    assert words_heard(spotter(), sound, own) == [halt, word]
    assert words_heard(spotter(), sound, other) == [halt, others[other].words[2]]
    assert words_heard(spotter(), sound, "en") == [halt]
    assert words_heard(spotter(), sound, "no language that it knows") == [halt]


def test_a_word_of_both_languages_is_one_stop(others, monkeypatch):
    monkeypatch.setattr(
        stop_spotter, "likelihoods", lambda weights, _: np.eye(len(weights.words))[[1]]
    )
    spotter = StopSpotter(Encoder(), read_weights(), others=others)

    assert len(words_heard(spotter, frames(OWN)[: 4 * LOOKS_EVERY], KNOWN[0])) == 1


def test_a_doubt_about_a_word_of_another_language_is_not_put_to_an_english_ear(others, monkeypatch):
    maybe = {4: [1.0, 0, 0, 0], 5: [0.4, 0.6, 0, 0, 0]}
    monkeypatch.setattr(
        stop_spotter, "likelihoods", lambda weights, _: np.array([maybe[len(weights.words)]])
    )
    asked = []
    spotter = StopSpotter(Encoder(), read_weights(), second=asked.append, others=others)

    assert not words_heard(spotter, frames(OWN), KNOWN[0])
    assert not asked


def test_the_ears_of_the_benchmark_hear_what_the_spotter_hears(others):
    sound, own = frames(OWN, ENGLISH, OWN, NOTHING, ENGLISH), KNOWN[0]
    weights = dataclasses.replace(read_weights(), threshold=0.9)
    spotter = StopSpotter(Encoder(), weights, others=others)
    ears = stop_words_ears.Ears(Encoder(), weights, None, Encoder(), others[own])

    stopped = [
        (number + 1) * FRAME_S
        for number, frame in enumerate(sound)
        if spotter.heard(frame, 1.0, own)
    ]

    assert len(stopped) == 4
    assert list(ears.stops(sound.ravel())) == stopped


@pytest.mark.parametrize("language", languages.languages())
def test_no_text_is_of_two_parts_but_for_the_words_alone(language):
    parts = {half: _texts(languages.texts(language, half)) for half in Half}

    for one in Half:
        for other in Half:
            if one is not other:
                alone = {_key(word) for word in languages.words(language)}
                assert parts[one] & parts[other] <= alone


@pytest.mark.parametrize("language", languages.languages())
def test_what_holds_no_stop_word_is_not_learnt_as_one(language):
    for half in Half:
        known = languages.texts(language, half)
        for text in (*known.alike, *known.talk):
            assert languages.has_none(text, language), text
        for word, texts in (*known.ends.items(), *known.within.items()):
            assert all(word.casefold() in text.casefold() for text in texts), texts


@pytest.mark.parametrize("language", languages.languages())
def test_who_trains_is_not_who_tests(language, monkeypatch):
    monkeypatch.setattr(voices, "kokoro_voices", lambda half: (f"kokoro:ef_{half.name}",))
    monkeypatch.setattr(languages, "kokoro_voices", voices.kokoro_voices)

    speak = {clip.voice for clip in language_clips.language_clips(language)}

    assert not speak & set(languages.espeak_speakers_of(language, Half.HELD_OUT))
    assert not speak & set(languages.espeak_speakers_of(language, Half.TUNING))
    assert {voice for voice in speak if voice.startswith("kokoro")} == {
        f"kokoro:ef_TRAIN@{language}"
    }


@pytest.mark.parametrize(
    ("language", "word", "own", "english"),
    [
        ("en", "", None, ""),
        ("en", "halt", None, "halt"),
        ("fr", "", "", ""),
        ("fr", "stop", "stop", "stop"),
        ("fr", "halte", "halte", None),
    ],
)
def test_what_is_said_in_a_language_is_judged_in_english_too(language, word, own, english):
    known = outputs.Outputs(["fr"])
    label = ("", *outputs.words_of(language)).index(word)

    found = known.wanted(language, label)

    assert [None if one == examples.IGNORED else known.words[one] for one in found] == [
        own,
        english,
    ]
    assert {known.languages[one] for one in found if one != examples.IGNORED} <= {language, "en"}
    assert known.of_english == len(known) - 5


def _texts(texts):
    every = [*texts.alike, *texts.talk]
    for some in (*texts.ends.values(), *texts.within.values()):
        every += some
    return {_key(text) for text in every}


def _key(text):
    return "".join(
        letter for letter in text.casefold() if letter.isalnum() or letter == " "
    ).strip()


def test_a_language_without_a_threshold_is_left_out(tmp_path):
    (tmp_path / "package").mkdir()
    place, (first, second) = tmp_path / "package" / WEIGHTS_FILE, KNOWN[:2]
    shutil.copy(SHIPPED, tmp_path)

    asked = [str(tmp_path), "--install", f"{first}=0.7", f"{second}=0.8"]
    assert train_stop_spotter.main(asked, place) == 0

    assert [one.name for one in place.parent.iterdir()] == [LANGUAGES_FILE]
    found = read_language_weights(place.with_name(LANGUAGES_FILE))
    assert {code: one.threshold for code, one in found.items()} == {first: 0.7, second: 0.8}
    some = np.ones((1, STEPS, CHANNELS), np.float32)
    for code, one in found.items():
        np.testing.assert_array_equal(
            likelihoods(one, some), likelihoods(read_language_weights()[code], some)
        )


@pytest.mark.parametrize(
    ("thresholds", "why"),
    [({"xx": 0.9}, "xx"), ({KNOWN[0]: 1.5}, "between 0 and 1"), ({KNOWN[0]: 0.0}, "between")],
)
def test_what_cannot_be_installed_changes_nothing(tmp_path, thresholds, why):
    place = tmp_path / "new.npz"
    place.write_bytes(b"before")

    with pytest.raises(installing.NotInstalled, match=why):
        installing.install_languages(SHIPPED, place, thresholds)

    assert place.read_bytes() == b"before"


def test_a_word_right_before_the_language_changes_keeps_no_other_from_stopping(others):
    spotter = StopSpotter(Encoder(), read_weights(), 0.9, others=others)
    said, english = frames(OWN)[: 4 * LOOKS_EVERY], frames(ENGLISH)

    assert words_heard(spotter, said, KNOWN[0]) == [others[KNOWN[0]].words[2]]
    assert words_heard(spotter, english, "en") == [read_weights().words[2]]
