"""What is spoken of a text, in which pieces, and what was heard of it when it was cut."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.languages import LANGUAGES
from edgevox.voice.sentence_synthesiser import normalise_for_speech, split_phrases
from edgevox.voice.spoken_answer import SpokenLog, cut_text

WORDS = st.lists(st.text("abcdeéß'.,", min_size=1, max_size=12), min_size=1, max_size=30)
SHARES = st.floats(0.0, 1.0)


@given(WORDS, SHARES)
def test_what_was_heard_is_whole_words_from_the_beginning(words: list[str], share: float):
    sentence = " ".join(words)
    heard = cut_text(sentence, share)
    assert sentence.startswith(heard)
    assert heard.split() == words[: len(heard.split())]
    assert len(heard) <= share * len(sentence) + 1e-6


@given(WORDS, SHARES, SHARES)
def test_more_sound_never_means_fewer_words(words: list[str], one: float, other: float):
    sentence = " ".join(words)
    less, more = sorted([one, other])
    assert cut_text(sentence, more).startswith(cut_text(sentence, less))


@given(st.text(max_size=40), st.booleans())
def test_all_of_the_sound_is_all_of_the_text_and_none_is_none(text: str, spaced: bool):
    assert cut_text(text, 1.0, spaced=spaced) == text
    assert cut_text(text, 0.0, spaced=spaced) == ""


@given(st.text("止まります台所", min_size=1, max_size=40), SHARES)
def test_without_spaces_it_is_cut_at_a_character(text: str, share: float):
    heard = cut_text(text, share, spaced=False)
    assert text.startswith(heard)
    assert abs(len(heard) - share * len(text)) <= 1.0


@given(WORDS, st.integers(20, 200))
def test_phrases_lose_nothing_but_spaces_and_are_never_too_long(words: list[str], length: int):
    sentence = " ".join(words)
    pieces = split_phrases(sentence, length)
    assert "".join(pieces).replace(" ", "") == sentence.replace(" ", "")
    assert all(0 < len(piece) <= 240 for piece in pieces)


def test_a_short_sentence_stays_whole():
    assert split_phrases("Yes, I do.", 50) == ["Yes, I do."]


def test_a_long_sentence_is_cut_where_a_speaker_may_pause():
    text = "The red cube lies on the table, next to the left bin, and I will pick it up, now."
    assert split_phrases(text, 50) == [
        "The red cube lies on the table,",
        "next to the left bin, and I will pick it up, now.",
    ]


def test_marks_of_other_scripts_are_pauses_too():
    assert split_phrases("私はロボットで台所に居ます、そして歩きます、それから戻ります。", 16) == [
        "私はロボットで台所に居ます、",
        "そして歩きます、",
        "それから戻ります。",
    ]


@pytest.mark.parametrize(
    ("written", "spoken"),
    [
        ("I am at x 6.6, y -2.", "I am at x 6.6, y minus 2."),
        ("x=6.6", "x 6.6"),
        ("It is -3 °C.", "It is minus 3 degrees."),
        ("Driving at 0.3 m/s", "Driving at 0.3 meters per second"),
        ("**Done**: see [the map](http://a.b/c).", "Done: see the map."),
        ("Look at https://www.example.org/a/b?c=d now", "Look at example.org now"),
        ("- one\n- two", "one two"),
        ("I call `navigate_to`.", "I call navigate to."),
        ("Great! 🎉👍🏽", "Great!"),
        ("```json\n{}\n``` Done.", "Done."),
        ("🎉", ""),
        ("...", ""),
        ("रोबोट रसोई में जाता है।", "रोबोट रसोई में जाता है।"),
        ("well-known", "well-known"),
        ("l'eau, ça va ?", "l'eau, ça va?"),
    ],
)
def test_signs_become_words_and_what_cannot_be_said_is_left_out(written: str, spoken: str):
    assert normalise_for_speech(written) == spoken


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_words_for_the_signs_that_a_voice_would_swallow(language: str):
    signs = LANGUAGES[language].signs
    spoken = normalise_for_speech("x 2, y -0.2, -3 °C & 0.3 m/s", language)

    assert signs.keys() == LANGUAGES["en"].signs.keys()
    assert all(words in spoken for words in signs.values())
    assert not set("-°&/") & set(spoken)


@pytest.mark.parametrize(
    ("language", "spoken"),
    [
        ("de", "Ich bin bei x 2, y minus 0,2."),
        ("fr", "Ich bin bei x 2, y moins 0,2."),
        ("ja", "Ich bin bei x 2, y マイナス 0,2."),
    ],
)
def test_a_minus_is_said_in_the_language_that_is_spoken(language: str, spoken: str):
    assert normalise_for_speech("Ich bin bei x 2, y -0,2.", language) == spoken


@given(st.text(max_size=200))
def test_any_text_becomes_one_line_with_something_to_say_or_nothing(text: str):
    spoken = normalise_for_speech(text)
    assert " ".join(spoken.split()) == spoken
    assert not spoken or any(character.isalnum() for character in spoken)


def test_of_a_sentence_that_is_still_being_synthesised_the_rest_is_estimated():
    log = SpokenLog()
    line = log.begin("one two three four")
    log.expect(line, 18, spaced=True)
    log.made(line, 1.0, 0.0)
    log.said(line, 8)
    log.played(line, 1.0)
    assert log.text() == "one two"


def test_silence_at_the_end_of_a_sentence_holds_no_words():
    log = SpokenLog()
    line = log.begin("one two")
    log.expect(line, 7, spaced=True)
    log.made(line, 1.0, 0.3)
    log.said(line, 7)
    log.complete(line)
    log.played(line, 1.0)
    assert log.text(unplayed_s=0.25) == "one two"
    assert log.text(unplayed_s=0.45) == "one"


def test_what_was_not_played_is_taken_from_the_end_over_sentences():
    log = SpokenLog()
    for sentence in ("one two.", "three four."):
        line = log.begin(sentence)
        log.made(line, 1.0, 0.0)
        log.complete(line)
        log.played(line, 1.0)
    assert log.text(unplayed_s=1.4) == "one"
    assert log.text(unplayed_s=0.2) == "one two. three"
