"""Stop means stop: however it is written, in sixteen languages, and nothing innocent does."""

import itertools
import string
import time
import tomllib
import unicodedata
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edgevox.agent.stop.words import SafetyWords
from edgevox.core.languages import LANGUAGES, STOP_SIGNS, STOP_WORDS

SENTENCES = tomllib.loads((Path(__file__).parents[1] / "stop_sentences.toml").read_text("utf-8"))
HALTS = {code: one["halts"] for code, one in SENTENCES.items()}
INNOCENT = {code: one["innocent"] for code, one in SENTENCES.items()}
ANYWHERE = [(code, word) for code, one in LANGUAGES.items() for word in one.stop.anywhere]
SHOUTS = ("Oh god", "Hey", "Please", "Maria", "Robbie", "Aaah", "OK", "Oh no")
"""What people say before a stop word without a pause."""
PUNCTUATION = ("! ", ", ", ". ", "... ", "!!! ", "; ", " - ", " — ", "!", "!?", "…", ": ")
HIDDEN = "\u200b\u200c\u200d\u2060\ufeff\u00ad\u034f\ufe0f\x00\x1b\x07\u202e"
LATIN_AS_CYRILLIC = str.maketrans("aeopcxysij", "аеорсхуѕіј")
FULL_WIDTH = str.maketrans({c: chr(ord(c) + 0xFEE0) for c in string.ascii_letters})


safety_words = cache(SafetyWords)


def halts(code, text):
    return safety_words(code).find(text) is not None


def is_latin(word):
    return word.replace(" ", "").isascii() and word.replace(" ", "").isalpha()


def is_of_letters(word):
    return len(word) > 2 and word.replace("'", "").isalpha()


def without_accents(word):
    apart = unicodedata.normalize("NFD", word.replace("đ", "d").replace("ł", "l"))
    return "".join(c for c in apart if not unicodedata.combining(c))


def said_long(word):
    return "".join(c * 4 if i == len(word) - 2 else c for i, c in enumerate(word))


@pytest.mark.parametrize("code", HALTS)
def test_what_people_say_to_stop_a_robot_halts_it(code):
    assert [text for text in HALTS[code] if not halts(code, text)] == []


@pytest.mark.parametrize("code", INNOCENT)
def test_what_only_sounds_like_it_does_not(code):
    assert [text for text in INNOCENT[code] if halts(code, text)] == []


def test_there_are_innocent_phrases_in_every_language():
    assert len(SENTENCES["en"]["innocent"]) >= 40
    assert all(len(SENTENCES[code]["innocent"]) >= 10 for code in LANGUAGES)


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_stop_word_halts_alone_in_any_case_and_again_and_again(code):
    for word in LANGUAGES[code].stop.all:
        for one in (word, word.upper(), word.capitalize(), f"{word}!", f"¡{word}!", f'"{word}"'):
            assert halts(code, one), one
        for again in (f"{word} {word}", f"{word}! {word}!", f"{word}, {word}, {word}"):
            assert halts(code, again), again


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_stop_word_halts_after_a_shout_that_could_be_a_negation(code):
    shouts = {SENTENCES[one][before] for before in ("no", "never") for one in (code, "en")}
    for word, shout, between in itertools.product(
        LANGUAGES[code].stop.all, sorted(shouts), PUNCTUATION
    ):
        assert halts(code, shout + between + word), shout + between + word
    for word, shout in itertools.product(LANGUAGES[code].stop.all, sorted(shouts)):
        assert halts(code, f"{shout}! {shout}! {word}!"), word


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_stop_word_halts_after_interjections_and_names(code):
    for word in LANGUAGES[code].stop.anywhere:
        for before, between in itertools.product(SHOUTS, (" ", ", ", "! ")):
            assert halts(code, before + between + word), before + between + word
        assert halts(code, f"x 4, y 0. {word}"), word
        assert halts(code, f"{word} please now"), word


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_stop_word_halts_with_hidden_characters_anywhere_in_it(code):
    for word in LANGUAGES[code].stop.anywhere:
        for number, i in enumerate(range(len(word) + 1)):
            hidden = HIDDEN[number % len(HIDDEN)]
            assert halts(code, word[:i] + hidden + word[i:]), (word, i, hex(ord(hidden)))
        assert halts(code, f"\x1b[31;1m{word}\x1b[0m"), word


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda one: hex(ord(one)))
def test_no_hidden_character_hides_a_stop_word(hidden):
    for code, i in itertools.product(LANGUAGES, range(5)):
        word = LANGUAGES[code].stop.anywhere[0]
        assert halts(code, word[:i] + hidden + word[i:]), (word, i)
    assert halts("en", f"go to the kitchen{hidden}stop")


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_stop_word_halts_in_letters_that_look_alike(code):
    for word in filter(is_latin, LANGUAGES[code].stop.anywhere):
        assert halts(code, word.translate(LATIN_AS_CYRILLIC)), word
        assert halts(code, word.translate(FULL_WIDTH)), word


@pytest.mark.parametrize("code", [code for code in LANGUAGES if LANGUAGES[code].spaced])
def test_a_stop_word_halts_spelled_out_said_long_glued_or_numbered(code):
    for word in filter(is_of_letters, LANGUAGES[code].stop.anywhere):
        written = [f"{word}2", f"2{word}", word * 3]
        if word.isalpha():
            written += [between.join(word) for between in (".", "-", " ", ", ")] + [said_long(word)]
        for one in written:
            assert halts(code, one), one


@pytest.mark.parametrize("code", [code for code in LANGUAGES if code not in ("hi", "ja")])
def test_a_stop_word_halts_without_its_accents_unless_that_is_another_word(code):
    another = {"vi": {"dung"}, "pl": {"stan"}, "pt": {"para"}}.get(code, set())
    for plain in set(map(without_accents, LANGUAGES[code].stop.all)) - another:
        assert halts(code, plain), plain


@pytest.mark.parametrize("code", LANGUAGES)
def test_english_stop_words_halt_in_every_language(code):
    for word in LANGUAGES["en"].stop.all:
        assert halts(code, word) or word in STOP_WORDS[code].ordinary, word


@pytest.mark.parametrize("sign", STOP_SIGNS)
def test_a_stop_sign_halts(sign):
    assert halts("en", sign)
    assert halts("zh", f"去厨房{sign}")
    assert halts("de", f"bitte {sign * 3}!")


@pytest.mark.parametrize("text", ["don't stop", "never stop", "bus stop"])
@pytest.mark.parametrize("between", ["! ", ", ", ". ", " — ", "…"])
def test_punctuation_ends_what_makes_a_stop_word_innocent(text, between):
    assert not halts("en", text)
    assert halts("en", text.replace(" ", between))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\u2028", "\u2029", "\x85"])
def test_the_end_of_a_line_ends_what_makes_a_stop_word_innocent(end):
    assert halts("en", f"don't{end}stop")
    assert halts("es", f"no{end}pare")
    assert halts("en", f"go to the kitchen{end}stop{end}")


@pytest.mark.parametrize(
    "said",
    ["ꜱᴛᴏᴘ", "🅢🅣🅞🅟", "🆂🆃🅾🅿", "🇸🇹🇴🇵", "ЅТОР", "НАLТ", "sτορ", "sŧop", "s⃝t⃝o⃝p⃝", "s⃠top", "ՏTOP"],
)  # fmt: skip
def test_a_stop_word_halts_in_framed_small_and_mixed_letters(said):
    assert halts("en", said)


def test_marks_on_characters_that_are_words_hide_nothing():
    for code, text in (("ja", "止まれ"), ("ja", "ストップ"), ("zh", "别动"), ("zh", "站住")):
        assert halts(code, "\u0335".join(text)), text


@pytest.mark.parametrize("code", HALTS)
def test_what_halts_still_does_after_a_no_and_before_exclamation_marks(code):
    for text in HALTS[code]:
        assert halts(code, f"No! {text}"), text
        assert halts(code, f"{text}!!!"), text


@pytest.mark.parametrize("code", ["en", "de", "fr", "ja", "zh"])
@pytest.mark.parametrize(
    "said", ["don't stop ", "never stop ", "不停", "止まっている", "a b ", "\ufdfa"]
)
def test_the_longest_text_is_searched_in_a_moment(code, said):
    text = (said * 8000)[:8000]
    began_s = time.process_time()
    safety_words(code).find(text)
    assert time.process_time() - began_s < 1.0


def test_a_stop_word_counts_beside_an_innocent_one():
    assert halts("en", "go to the bus stop, no, stop")
    assert halts("en", "don't stop stop")
    assert halts("fr", "ne t'arrête pas ! arrête !")


def test_a_stop_word_is_found_at_both_ends_of_a_text_that_is_too_long_to_be_done():
    assert halts("en", "x" * 100_000 + " freeze")
    assert halts("en", "freeze " + "x" * 100_000)


def test_a_stop_word_is_found_anywhere_in_a_text_that_is_too_long_to_be_done():
    for beside in (4_400, 60_000):
        assert halts("en", "so " * beside + "stop " + "so " * beside)
    assert not halts("en", "so " * 60_000 + "the bus stop is near " + "so " * 60_000)
    assert halts("en", "x " * 9_000 + "bus stop " * 9_000), "of so many one may be meant"


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_stop_word_of_any_language_halts_alone_or_first_in_every_other(code):
    ordinary = {word.casefold() for word in (*STOP_WORDS[code].ordinary, *STOP_WORDS[code].all)}
    for other in LANGUAGES:
        for said in (*STOP_WORDS[other].anywhere, *STOP_WORDS[other].last):
            if said.casefold() not in ordinary:
                assert halts(code, said), (code, other, said)
                assert halts(code, f"{said}!"), (code, other, said)
                assert halts(code, f"{said}, robot"), (code, other, said)


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("fr", "va à la cuisine stp"),
        ("fr", "dur"),
        ("de", "alt"),
        ("it", "alto"),
        ("tr", "para"),
        ("nl", "halte"),
        ("en", "the alto sings"),
        ("ja", "停電です"),
        ("en", "play it in c dur"),
    ],
)
def test_a_word_of_the_language_that_is_spoken_is_no_stop_word_of_another(code, text):
    assert not halts(code, text)


@given(st.lists(st.sampled_from(["go", "to", "kitchen", "please", "ok", "7"]), max_size=6))
def test_stop_before_and_after_any_other_words_halts(words):
    assert safety_words("en").find(" ".join([*words, "stop"])) == "stop"
    assert safety_words("en").find(" ".join(["stop", *words])) == "stop"


@given(
    st.sampled_from(ANYWHERE),
    st.sampled_from(SHOUTS),
    st.sampled_from(PUNCTUATION),
    st.text(HIDDEN, max_size=3),
    st.sampled_from([str.lower, str.upper, str.title]),
    st.integers(1, 4),
)
@settings(max_examples=400, deadline=None)
def test_all_of_it_at_once_halts(stop, before, between, hidden, case, times):
    code, word = stop
    said = " ".join([case(word)] * times)
    assert halts(code, before + between + said[:1] + hidden + said[1:] + "!")


@given(st.sampled_from(sorted(LANGUAGES)), st.text(max_size=300))
@settings(deadline=None)
def test_any_text_is_searched_without_failing(code, text):
    found = safety_words(code).find(text)
    assert found is None or found


@pytest.mark.parametrize(
    ("code", "says", "word"),
    [
        ("en", "wait I wasn't ready", "wait"),
        ("en", "oh no, hang on there's somebody in the way", "hang on"),
        ("de", "warte ich bin noch nicht da", "warte"),
        ("fr", "oh attendez il y a quelqu'un", "attendez"),
        ("es", "espera que no estoy listo", "espera"),
        ("pl", "nie, czekaj na mnie", None),
        ("pl", "czekaj, ktoś tam jest", "czekaj"),
        ("pt", "não espere por mim", None),
        ("vi", "cho tôi hỏi pin còn bao nhiêu", None),
        ("ja", "ちょっと待って人がいる", "ちょっと待って"),
        ("zh", "等一下我还没准备好", "等一下"),
        ("en", "go to the kitchen and wait for me", None),
        ("en", "I can't wait to see it", None),
        ("en", "don't wait for me", None),
    ],
)
def test_a_wait_that_opens_what_is_said_is_found_and_no_other(code, says, word):
    assert SafetyWords(code).opens(says) == word
