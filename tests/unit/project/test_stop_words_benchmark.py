"""The benchmark of stop words: what it stands on, and that nothing is left out unsaid."""

import dataclasses
import re
from functools import partial
from itertools import combinations, islice

import numpy as np
import pytest
from stop_words_rig import (
    Figure,
    Half,
    NotHere,
    Speaker,
    clips,
    interval,
    sentences,
    stop_words,
    stop_words_ears,
    stop_words_sounds,
    stop_words_threshold,
    texts,
    voices,
    wilson,
)

from edgevox.models import ModelMissing
from edgevox.models.store import Store
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES
from edgevox.voice.stop_spotter import spotter as stop_spotter
from edgevox.voice.stop_spotter.network import CHANNELS, STEPS, read_weights
from edgevox.voice.stop_spotter.spotter import StopSpotter

LETTERS = re.compile(r"[^a-z0-9]")


def key(text: str) -> str:
    return LETTERS.sub("", text.casefold())


@pytest.fixture
def speaker(monkeypatch):
    return Speaker(monkeypatch)


@pytest.fixture
def all_kokoro(monkeypatch, tmp_path):
    """The folder of Kokoro's voices, with those of every part and two others in it."""
    some = [*voices.kokoro_voices(Half.HELD_OUT), *voices.kokoro_voices(Half.TUNING)]
    (tmp_path / "voices").mkdir()
    for voice in [*some, "kokoro:af_heart", "kokoro:bm_lewis"]:
        (tmp_path / "voices" / f"{voice.removeprefix('kokoro:')}.bin").touch()
    monkeypatch.setattr(voices, "locate", lambda _: tmp_path)


@pytest.mark.parametrize("one_and_other", [*combinations(Half, 2)])
def test_no_voice_and_no_sentence_is_of_two_parts(all_kokoro, one_and_other):
    for told in (
        voices.espeak_voices,
        voices.kokoro_voices,
        lambda half: [key(one) for one in sentences.sentences(half)],
    ):
        one, other = (set(told(half)) for half in one_and_other)
        assert one
        assert other
        assert one.isdisjoint(other)


def test_no_sentence_to_tune_or_test_with_is_said_in_the_training():
    learnt = {key(one) for one in (*texts.COMMANDS, *texts.OWN, *texts.CHAT, *texts.ALIKE)}

    for half in (Half.TUNING, Half.HELD_OUT):
        assert learnt.isdisjoint(key(one) for one in sentences.sentences(half))


@pytest.mark.parametrize("half", Half)
def test_no_sentence_holds_a_stop_word(half):
    wrong = re.compile(r"stop|halt|fre[ea]z|friez|frees", re.IGNORECASE)

    assert not [one for one in sentences.sentences(half) if wrong.search(one)]


def test_all_that_is_to_be_said_is_there_however_empty_the_cache_is(speaker):
    before = stop_words_sounds.clips(Half.HELD_OUT)
    some = before[:60]

    clips.speak(some, lambda _: None)

    assert stop_words_sounds.clips(Half.HELD_OUT) == before
    assert speaker.said == [(clip.voice, clip.text) for clip in some]


def test_what_was_spoken_before_it_was_broken_off_is_not_spoken_again(speaker):
    some, told = stop_words_sounds.words(Half.HELD_OUT)[:120], []
    clips.speak(some[:70], lambda _: None)
    speaker.said.clear()

    clips.speak(some, told.append)

    assert speaker.said == [(clip.voice, clip.text) for clip in some[70:]]
    assert told[-1] == f"50 of 50 clips spoken, the last by {some[-1].voice}"


def test_nothing_is_measured_while_a_clip_is_missing_and_one_line_says_what_to_do(speaker):
    whole = stop_words_sounds.clips(Half.HELD_OUT)
    clips.speak(whole[1:], lambda _: None)

    with pytest.raises(NotHere) as raised:
        stop_words.measure()

    number, total = re.match(r"(\d+) of (\d+) clips", str(raised.value)).groups()
    assert (int(number), int(total)) == (1, len(whole))
    assert str(raised.value).endswith("python -m benchmarks.hearing.stop_words.english --speak")


def test_a_voice_that_is_not_here_ends_with_the_line_that_fetches_it(monkeypatch, tmp_path):
    nothing = Store(tmp_path)
    monkeypatch.setattr(clips, "is_cached", lambda *_, **__: False)
    monkeypatch.setattr(clips, "say", lambda *_, **__: nothing.locate("kokoro-82m"))

    with pytest.raises(ModelMissing, match="edgevox-models fetch kokoro-82m"):
        clips.speak(stop_words_sounds.clips(Half.HELD_OUT), lambda _: None)


def test_there_are_words_enough_of_natural_voices_to_show_what_is_wanted():
    natural = [one for one in stop_words_sounds.words(Half.HELD_OUT) if one.engine == "kokoro"]

    assert len(set(natural)) == len(natural)
    assert len({one.voice for one in natural}) >= 9
    assert len({one.speed for one in natural}) >= 3
    low, _ = wilson(len(natural), len(natural))
    assert low >= 0.995


def test_every_word_of_the_benchmark_is_one_that_the_spotter_knows():
    for clip in stop_words_sounds.words(Half.HELD_OUT):
        assert clip.word in texts.WORDS
        assert clip.word in clip.text.casefold()
        assert clip.within == (not re.search(rf"{clip.word}[!.]$", clip.text.casefold()))


def test_figures_say_how_many_clips_of_which_voices_they_stand_on():
    some = [
        clips.Clip("kokoro:af_nova", "Stop!"),
        clips.Clip("kokoro:af_nova", "Stop!", speed=1.2),
        clips.Clip("kokoro:af_nova", "Stop!"),
        clips.Clip("espeak:en-us+max", "Halt!"),
        clips.Clip("espeak:en-gb+max", "Halt!"),
    ]

    assert clips.standing_on("stop words", some) == (
        "stop words: 2 clips of Kokoro, 1 voices: af_nova",
        "stop words: 2 clips of espeak-ng, 1 speakers in 2 accents: max",
    )


@pytest.mark.parametrize(
    ("hits", "tries", "low", "high"),
    [
        (0, 10, 0.0, 0.2775),
        (10, 10, 0.7225, 1.0),
        (50, 100, 0.4038, 0.5962),
        (600, 600, 0.9936, 1.0),
    ],
)
def test_the_interval_of_a_share_is_wilsons(hits, tries, low, high):
    assert wilson(hits, tries) == pytest.approx((low, high), abs=1e-4)


def test_a_share_stands_with_its_interval_and_the_number_of_tries():
    figure = Figure.share("heard", "Heard", "all", 97, 100, wanted=99.5, more_is_better=True)

    assert (figure.value, figure.n, figure.unit) == (97.0, 100, "%")
    assert interval(figure) == "91.5 to 99.0 %"
    assert figure.missed


class Hears:
    """Ears that stop so many seconds after the beginning of every sound."""

    def __init__(self, *stops_s: float) -> None:
        self._stops_s = stops_s

    def stops(self, _):
        return iter(self._stops_s)


@pytest.mark.parametrize(
    ("stops_s", "heard"),
    [((), False), ((0.5,), False), ((1.6,), True), ((0.5, 1.75), True), ((2.4,), False)],
)
def test_a_word_is_heard_from_its_beginning_until_half_a_second_after_its_end(
    speaker, stops_s, heard
):
    said = [clips.Clip("kokoro:af_nova", "Stop!", "stop")]  # from 1.2 s to about 1.7 s

    (trial,) = stop_words_ears.trials(Half.HELD_OUT, Hears(*stops_s), said, None)

    assert trial.heard is heard


def test_a_stop_before_a_word_that_comes_last_has_not_heard_it(speaker, monkeypatch):
    monkeypatch.setattr(clips, "say", lambda *_, **__: np.full(32_000, 3000, np.int16))
    said = clips.Clip("kokoro:af_nova", "Everybody stop!", "stop")  # from 1.2 s to about 3.2 s
    goes_on = dataclasses.replace(said, text="Stop moving!", within=True)

    heard = [
        trial.heard
        for stop_s in (1.8, 3.0)
        for trial in stop_words_ears.trials(Half.HELD_OUT, Hears(stop_s), [said, goes_on], None)
    ]

    assert heard == [False, True, True, True]


def test_the_time_of_a_stop_counts_from_the_end_of_the_word(speaker):
    said = [clips.Clip("kokoro:af_nova", "Stop!", "stop")]
    (spot,) = stop_words_ears.spots(Half.HELD_OUT, said, None)

    assert spot.heard(iter([spot.ends_s + 0.02])) == pytest.approx(0.02)
    assert spot.sound.size / 16_000 > spot.ends_s + 0.8


class Loudness:
    """Stands for the encoder: how loud each sound is, and for what it makes of a voice."""

    def of(self, sounds):
        return np.stack([np.full((STEPS, CHANNELS), np.abs(one).mean()) for one in sounds])

    def probability(self, samples):
        return float(np.abs(samples).max() > 1000)

    def reset(self):
        pass


def test_the_ears_of_the_benchmark_hear_what_the_spotter_hears(monkeypatch):
    for module in (stop_words_ears, stop_spotter):
        monkeypatch.setattr(
            module, "likelihoods", lambda _, encoded: np.stack(
                [[1 - level, level, 0, 0] for level in encoded[:, 0, 0] / 10_000]
            )
        )  # fmt: skip
    rng, hears = np.random.default_rng(3), Loudness()
    levels = [0, 9000, 300, 0, 9500, 9000, 900, 6000, 900, 900, 9900, 6500, 900, 6500, 900, 9700]
    levels = np.repeat(levels, 25)
    sound = (rng.choice([-1, 1], (len(levels), FRAME_SAMPLES)) * levels[:, None]).astype(np.int16)
    weights, asked = read_weights(), [[], []]

    def second(by, heard):
        by.append(heard.copy())
        return float(np.abs(heard[-FRAME_SAMPLES:]).mean() > 6200)

    ears = stop_words_ears.Ears(hears, weights, partial(second, asked[0]), hears)
    spotter = StopSpotter(hears, weights, second=partial(second, asked[1]))

    stopped = [
        (number + 1) * FRAME_S
        for number, frame in enumerate(sound)
        if spotter.heard(frame, hears.probability(frame))
    ]

    assert len(stopped) == 6
    assert list(ears.stops(sound.ravel())) == stopped
    assert len(asked[0]) > 4
    np.testing.assert_array_equal(asked[0], asked[1])


def test_no_sentence_comes_again_before_all_of_its_engine_were_heard(speaker):
    said = stop_words_sounds.talk(Half.TUNING)
    natural = [clip for clip in said if clip.engine == "kokoro"]

    told = (track.clip for track in stop_words_sounds.tracks(Half.TUNING, "speech", 1e9))
    heard = list(islice((one for one in told if one.engine == "kokoro"), len(natural)))

    assert sorted(heard, key=repr) == sorted(natural, key=repr)


def test_a_false_stop_is_told_with_what_was_said_then(speaker):
    ears = Hears(0.3)
    ears.word = "halt"

    heard = stop_words_ears.stretches(Half.HELD_OUT, "speech", 0.001)
    found = stop_words_ears.false_stops(ears, "speech", heard)

    first = found.clips[0]
    assert found.wrong == (f"speech: {first.voice} {first.text} (took it for halt)",)
    assert found.hours >= 0.001


class Looks:
    """Ears that are as sure of every sound."""

    def __init__(self, sure: float, second: object = None) -> None:
        self._sure = sure
        self.second = second

    def looks(self, _):
        return np.full(1, self._sure)

    def judged(self, looks, threshold=0.0, least_odds=0.0):
        return iter([1.5] if looks[0] >= max(threshold, least_odds) else [])


def test_the_threshold_is_chosen_with_what_is_neither_learnt_nor_tested(speaker):
    said = stop_words_sounds.words(stop_words_threshold.HALF)[:3]

    found, hours = stop_words_threshold.rows(Looks(0.82), said, 0.001)

    assert {clip.voice for clip in said} <= set(voices.kokoro_voices(Half.TUNING))
    heard = {row.least: (row.heard, row.false > 0) for row in found}
    assert heard[0.8] == ((3, 3, 3), True)
    assert heard[0.85] == ((0, 0, 0), False)
    found, hours = stop_words_threshold.rows(Looks(0.15, "somebody"), said, 0.001)
    heard = {row.least: (row.heard, row.false > 0) for row in found}
    assert heard[0.1] == ((3, 3, 3), True)
    assert heard[0.2] == ((0, 0, 0), False)
    shown = list(stop_words_threshold.lines(found, len(said), hours))
    assert "100.0 % (43.9 to 100.0)" in shown[1]


def test_a_clip_is_the_same_only_if_it_is_said_the_same_way(speaker):
    clip = clips.Clip("kokoro:af_nova", "Stop!")
    clips.speak([clip], lambda _: None)

    assert clip.is_here
    assert not dataclasses.replace(clip, speed=1.2).is_here
